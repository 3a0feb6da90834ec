#include <fmt/format.h>

#include <titop/analysis/reduction/real_modes.hpp>
#include <titop/analysis/reduction/reduced_data.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/pole.hpp>

/// The forms that a reduced system can be had in.
namespace titop {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

MatrixXd damping(const detail::Small& m) {
  return m.Z.size() ? m.Z : MatrixXd(MatrixXd::Zero(m.order(), m.order()));
}

/// All positions, then all rates.
StateSpace by_halves(const detail::Small& m) {
  const Index r = m.order();
  const MatrixXd Z = damping(m);
  StateSpace s;
  s.A = MatrixXd::Zero(2 * r, 2 * r);
  s.A.topRightCorner(r, r).setIdentity();
  s.A.bottomLeftCorner(r, r) = (-m.k).asDiagonal();
  s.A.bottomRightCorner(r, r) = -Z;
  s.B = MatrixXd::Zero(2 * r, m.b.cols());
  s.B.bottomRows(r) = m.b;
  s.C.resize(m.ca.rows(), 2 * r);
  s.C.leftCols(r) = m.cq - m.ca * m.k.asDiagonal();
  s.C.rightCols(r) = m.cv - m.ca * Z;
  s.D = m.D0 + m.ca * m.b;
  return s;
}

/// The states in this order.
StateSpace select(const StateSpace& m, const std::vector<Index>& states) {
  StateSpace s = m;
  s.A = m.A(states, states);
  s.B = m.B(states, Eigen::all);
  s.C = m.C(Eigen::all, states);
  return s;
}

/// The coordinates that damping couples, as 2 x 2 blocks.
void add_coupled(ModalModel& result, const StateSpace& m, const std::vector<Index>& states) {
  const MatrixXd A = m.A(states, states);
  const detail::RealModes modes = detail::real_modes(A, "second_order() or state_space()");
  const Index first = 2 * static_cast<Index>(result.A.size()), n = A.rows();
  result.A.insert(result.A.end(), modes.A.begin(), modes.A.end());
  for (const double pole : modes.single) result.A.emplace_back(pole * Eigen::Matrix2d::Identity());
  result.B.middleRows(first, n) =
      MatrixXd(modes.T.partialPivLu().solve(MatrixXd(m.B(states, Eigen::all))));
  result.C.middleCols(first, n) = m.C(Eigen::all, states) * modes.T;
}

}  // namespace

StateSpace ReducedSystem::state_space() const {
  if (data_->states) {
    StateSpace s = data_->states->state_space();
    s.inputs = inputs();
    s.outputs = outputs();
    return s;
  }
  const detail::Small& m = data_->small;
  std::vector<Index> kept;
  std::vector<std::string> names;
  for (Index j = 0; j < m.order(); ++j)
    if (m.has_position(j)) {
      kept.push_back(j);
      names.push_back(fmt::format("mode{}", j + 1));
    }
  for (Index j = 0; j < m.order(); ++j) {
    kept.push_back(m.order() + j);
    names.push_back(fmt::format("mode{}_rate", j + 1));
  }
  StateSpace s = select(by_halves(m), kept);
  s.states = std::move(names);
  s.inputs = inputs();
  s.outputs = outputs();
  return s;
}

SecondOrderModel ReducedSystem::second_order() const {
  if (data_->states)
    throw Error(Code::bad_value,
                fmt::format("the reduced {} is no second-order model: {}",
                            full().stage().graph.name, data_->states->why),
                "take state_space() or modal()");
  const detail::Small& m = data_->small;
  const MatrixXd Z = damping(m);
  SecondOrderModel s{.M = MatrixXd::Identity(m.order(), m.order()),
                     .D = (Z + Z.transpose()) / 2,
                     .G = (Z - Z.transpose()) / 2,
                     .K = m.k.asDiagonal(),
                     .B = m.b,
                     .C = m.cq,
                     .C_rate = m.cv,
                     .C_accel = m.ca,
                     .direct = m.D0,
                     .coordinates = {},
                     .inputs = inputs(),
                     .outputs = outputs()};
  for (Index j = 0; j < m.order(); ++j) s.coordinates.push_back(fmt::format("mode{}", j + 1));
  return s;
}

MatrixXcd SecondOrderModel::transfer(Complex s) const {
  const MatrixXcd c =
      s * s * C_accel.cast<Complex>() + s * C_rate.cast<Complex>() + C.cast<Complex>();
  MatrixXcd S = s * s * M.cast<Complex>() + s * D.cast<Complex>() + K.cast<Complex>();
  if (G.size() > 0) S += s * G.cast<Complex>();
  if (S.rows() == 0) return direct.cast<Complex>();
  const auto solved = linalg::solve(S, B.cast<Complex>());
  if (!(solved.rcond > 0) || !solved.z.allFinite() ||
      (s == 0.0 && solved.moved > linalg::kOneDigit))
    throw pole_at(s, "the reduced structure");
  return direct.cast<Complex>() + c * solved.z;
}

ModalModel ReducedSystem::modal() const {
  if (data_->states) {
    ModalModel result = data_->states->modal();
    result.inputs = inputs();
    result.outputs = outputs();
    return result;
  }
  const detail::Small& m = data_->small;
  const StateSpace halves = by_halves(m);
  const Index r = m.order(), own = m.Z.size() ? m.own : r;
  ModalModel result{{},
                    MatrixXd::Zero(2 * r, m.b.cols()),
                    MatrixXd::Zero(m.ca.rows(), 2 * r),
                    halves.D,
                    inputs(),
                    outputs()};
  for (Index j = 0; j < own; ++j) {
    const std::vector<Index> pair{j, r + j};
    result.A.emplace_back(halves.A(pair, pair));
    result.B.middleRows<2>(2 * j) = halves.B(pair, Eigen::all);
    result.C.middleCols<2>(2 * j) = halves.C(Eigen::all, pair);
  }
  std::vector<Index> rest;
  for (Index j = own; j < r; ++j)
    if (m.has_position(j)) rest.push_back(j);
  for (Index j = own; j < r; ++j) rest.push_back(r + j);
  if (!rest.empty()) add_coupled(result, halves, rest);
  const auto states = 2 * static_cast<Index>(result.A.size());
  result.B.conservativeResize(states, Eigen::NoChange);
  result.C.conservativeResize(Eigen::NoChange, states);
  return result;
}

MatrixXcd ModalModel::transfer(Complex s) const {
  MatrixXcd H = D.cast<Complex>();
  for (std::size_t k = 0; k < A.size(); ++k) {
    const Eigen::Matrix2d& a = A[k];
    const Complex det = (s - a(0, 0)) * (s - a(1, 1)) - a(0, 1) * a(1, 0);
    if (det == 0.0) throw pole_at(s, fmt::format("mode {} of the reduced system", k + 1));
    Eigen::Matrix2cd inverse;
    inverse << s - a(1, 1), a(0, 1), a(1, 0), s - a(0, 0);
    const auto i = 2 * static_cast<Index>(k);
    H += C.middleCols<2>(i) * (inverse / det) * B.middleRows<2>(i);
  }
  return H;
}

}  // namespace titop
