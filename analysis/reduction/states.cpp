#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/analysis/reduction/real_modes.hpp>
#include <titop/analysis/reduction/small.hpp>
#include <titop/analysis/reduction/states.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/pole.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A part that consists of integrators only, as pairs x1' = x2 and single ones.
RealModes integrators(const MatrixXd& N) {
  const Index n = N.rows();
  if (n == 0) return {MatrixXd(0, 0), {}, {}};
  if (!(N * N).isZero(kNothing * N.squaredNorm()))
    throw Error(Code::singular,
                "the reduced system has a triple integrator, which is no block of 2 x 2",
                "take state_space()");
  const Eigen::JacobiSVD<MatrixXd> svd(N, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Index pairs = 0;
  while (pairs < n && svd.singularValues()(pairs) > kNothing * svd.singularValues()(0)) ++pairs;
  // States that are neither a rate nor its position: rows of the null space without the range.
  MatrixXd used(n, 2 * pairs);
  used << svd.matrixU().leftCols(pairs), svd.matrixV().leftCols(pairs);
  RealModes m{MatrixXd(n, n), {}, {}};
  for (Index j = 0; j < pairs; ++j) {
    m.T.col(2 * j) = svd.singularValues()(j) * svd.matrixU().col(j);
    m.T.col(2 * j + 1) = svd.matrixV().col(j);
    m.A.push_back((Eigen::Matrix2d() << 0, 1, 0, 0).finished());
  }
  const Index single = n - 2 * pairs;
  if (single > 0)
    m.T.rightCols(single) =
        pairs == 0 ? MatrixXd(MatrixXd::Identity(n, n))
                   : MatrixXd(Eigen::JacobiSVD<MatrixXd>(used.transpose(), Eigen::ComputeFullV)
                                  .matrixV()
                                  .rightCols(single));
  for (Index j = 0; j < single / 2; ++j) m.A.push_back(Eigen::Matrix2d::Zero());
  if (single % 2 == 1) m.single.push_back(0);
  return m;
}

bool is_strict_triangle(const MatrixXd& A) {
  return A.isUpperTriangular(0) && A.diagonal().isZero(0);
}

/// Appends a part as blocks; a single real pole has a block by itself.
void add_blocks(ModalModel& result, const SpectralPart& part, const RealModes& modes) {
  const Index n = part.order(), first = 2 * static_cast<Index>(result.A.size());
  result.A.insert(result.A.end(), modes.A.begin(), modes.A.end());
  for (const double pole : modes.single) {
    Eigen::Matrix2d block = Eigen::Matrix2d::Zero();
    block(0, 0) = block(1, 1) = pole;
    result.A.push_back(block);
  }
  const Index all = 2 * static_cast<Index>(result.A.size());
  result.B.conservativeResize(all, Eigen::NoChange);
  result.C.conservativeResize(Eigen::NoChange, all);
  result.B.bottomRows(all - first).setZero();
  result.C.rightCols(all - first).setZero();
  if (n == 0) return;
  result.B.middleRows(first, n) = MatrixXd(modes.T.partialPivLu().solve(part.B));
  result.C.middleCols(first, n) = part.C * modes.T;
}

KeptMode mode_of(Complex pole) {
  KeptMode m;
  m.hertz = std::abs(pole) / (2 * std::numbers::pi);
  if (pole != 0.0) m.damping = -pole.real() / std::abs(pole);
  return m;
}

/// Shares by participation factors, summed over the states of each block.
void set_blocks(KeptMode& mode, const VectorXd& share, const std::vector<std::string>& states) {
  std::map<std::string, double> sum;
  for (Index i = 0; i < share.size(); ++i) {
    const std::string& name = states[static_cast<std::size_t>(i)];
    sum[name.substr(0, name.rfind('.'))] += share(i);
  }
  for (const auto& [name, value] : sum)
    if (const double total = share.sum(); total > 0 && value >= 0.05 * total)
      mode.blocks.emplace_back(name, value / total);
  std::stable_sort(mode.blocks.begin(), mode.blocks.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

}  // namespace

States::PartialFractions piece(SpectralPart part) {
  States::PartialFractions p{std::move(part), {}, {}, {}};
  if (p.part.order() == 0 || is_strict_triangle(p.part.A)) return p;
  const linalg::Eigensystem e = linalg::eigensystem(p.part.A);
  if (!(e.rcond_V > kDefective)) return p;
  p.pole = e.values;
  p.left = p.part.C * e.V;
  p.right = e.W * p.part.B;
  return p;
}

MatrixXcd transfer(const SpectralPart& p, Complex s) {
  if (p.order() == 0) return MatrixXcd::Zero(p.C.rows(), p.B.cols());
  MatrixXcd S = -p.A.cast<Complex>();
  S.diagonal().array() += s;
  const Eigen::PartialPivLU<MatrixXcd> lu(S);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) throw pole_at(s, "the reduced system");
  return p.C * MatrixXcd(lu.solve(MatrixXcd(p.B.cast<Complex>())));
}

Index States::order() const {
  Index n = 0;
  for (const PartialFractions& p : pieces) n += p.part.order();
  return n;
}

MatrixXcd States::transfer(Complex s) const {
  MatrixXcd H = D.cast<Complex>();
  for (const PartialFractions& p : pieces) {
    if (p.pole.size() == 0)
      H += detail::transfer(p.part, s);
    else
      H += p.left * (s - p.pole.array()).inverse().matrix().asDiagonal() * p.right;
  }
  return H;
}

std::vector<Complex> States::poles() const {
  std::vector<Complex> result;
  for (const PartialFractions& p : pieces) {
    const Eigen::VectorXcd all = p.pole.size() ? p.pole
                                 : is_strict_triangle(p.part.A)
                                     ? Eigen::VectorXcd::Zero(p.part.order())
                                     : linalg::eigenvalues(p.part.A);
    for (const Complex& s : all)
      if (s.imag() >= 0) result.push_back(s);
  }
  return result;
}

StateSpace States::state_space() const {
  const Index n = order();
  StateSpace m;
  m.A = MatrixXd::Zero(n, n);
  m.B.resize(n, D.cols());
  m.C.resize(D.rows(), n);
  m.D = D;
  Index first = 0;
  for (const PartialFractions& p : pieces) {
    const Index r = p.part.order();
    m.A.block(first, first, r, r) = p.part.A;
    m.B.middleRows(first, r) = p.part.B;
    m.C.middleCols(first, r) = p.part.C;
    first += r;
  }
  const Index balanced = pieces.back().part.order();
  for (Index j = 0; j < n; ++j)
    m.states.push_back(j < n - balanced ? fmt::format("kept{}", j + 1)
                                        : fmt::format("balanced{}", j + 1 - (n - balanced)));
  return m;
}

ModalModel States::modal() const {
  ModalModel result{{}, MatrixXd(0, D.cols()), MatrixXd(D.rows(), 0), D, {}, {}};
  for (const PartialFractions& p : pieces)
    add_blocks(result, p.part,
               is_strict_triangle(p.part.A) ? integrators(p.part.A)
                                            : real_modes(p.part.A, "state_space()"));
  return result;
}

std::vector<KeptMode> States::modes(const std::vector<std::string>& states) const {
  std::vector<KeptMode> result;
  for (const PartialFractions& p : pieces) {
    const bool balanced = &p == &pieces.back();
    const auto add = [&](Complex pole, const VectorXd& share) {
      KeptMode m = mode_of(pole);
      m.exact = !balanced;
      m.balanced = balanced;
      set_blocks(m, share, states);
      result.push_back(std::move(m));
    };
    if (is_strict_triangle(p.part.A)) {
      for (Index j = 0; j < p.part.order(); ++j)
        add(0, p.part.left.row(j).transpose().cwiseProduct(p.part.right.col(j)).cwiseAbs());
      continue;
    }
    const linalg::Eigensystem e = linalg::eigensystem(p.part.A);
    const MatrixXcd right = p.part.right * e.V, left = e.W * p.part.left;
    for (Index j = 0; j < e.values.size(); ++j)
      if (e.values(j).imag() >= 0)
        add(e.values(j), right.col(j).cwiseProduct(left.row(j).transpose()).cwiseAbs());
  }
  return result;
}

}  // namespace titop::detail
