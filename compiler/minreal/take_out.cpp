#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/take_out.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/name_order.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSmallShare = 1e-4;  ///< of a mode in another by rounding, at most

using linalg::at;

/// Best columns as pivots of the rows of W (k x n): pivoted QR.
std::vector<int> pivots(const MatrixXd& W) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(W);
  std::vector<int> result;
  for (Index k = 0; k < W.rows(); ++k)
    result.push_back(static_cast<int>(qr.colsPermutation().indices()(k)));
  std::sort(result.begin(), result.end());
  return result;
}

/// out = R keep on the span of the relations (rows W), with the states in units of `scale`:
/// coefficients that are only rounding there are 0, so that zeros of the model stay zeros.
MatrixXd solve_for(const MatrixXd& W, const std::vector<int>& out, const std::vector<int>& keep,
                   const VectorXd& scale, double noise) {
  const MatrixXd S = W * scale.asDiagonal();
  MatrixXd R = MatrixXd(S(Eigen::all, out)).fullPivLu().solve(MatrixXd(-S(Eigen::all, keep)));
  R = (R.array().abs() <= noise).select(0.0, R);
  return scale(out).asDiagonal() * R * scale(keep).cwiseInverse().asDiagonal();
}

void keep_names(StateSpace& m, const std::vector<int>& keep) {
  m.states = names_at(m.states, keep);
  m.rates = names_at(m.rates, keep);
}

/// Modes that leave a model by one of their sides.
struct LeavingModes {
  MatrixXd W;  ///< rows: of x, the modes' coordinates up to a factor
  MatrixXd V;  ///< columns: their motions
};

/// Modes to remove: relations `undriven.W` x = 0 that are satisfied for all inputs, and motions
/// `unseen.V` that are unobservable. `scale`: units of the states.
struct LeavingSides {
  LeavingModes undriven, unseen;
  VectorXd scale;
  double noise;
};

/// left right, without entries at the rounding level of vectors of this size, the states in
/// units of `scale`.
MatrixXd cleared_product(const MatrixXd& left, const MatrixXd& right, const VectorXd& scale,
                         double noise) {
  const VectorXd l = (left * scale.asDiagonal()).rowwise().norm(),
                 r = (scale.cwiseInverse().asDiagonal() * right).colwise().norm();
  const MatrixXd product = left * right;
  return (product.array().abs() <= noise * (l * r.transpose()).array()).select(0.0, product);
}

/// B -= V (W V)^-1 W B. Otherwise the inputs of removed modes would act on kept ones: then the
/// transfer would change in proportion to them, and not to their product with the outputs.
void drive_no_more(const LeavingSides& l, MatrixXd& B) {
  const auto& [W, V] = l.undriven;
  const MatrixXd driven = cleared_product(W, B, l.scale, l.noise);
  if (!driven.isZero(0)) B -= V * MatrixXd(W * V).partialPivLu().solve(driven);
}

/// C -= C V (W V)^-1 W, likewise.
void see_no_more(const LeavingSides& l, MatrixXd& C) {
  const auto& [W, V] = l.unseen;
  const MatrixXd seen = cleared_product(C, V, l.scale, l.noise);
  if (!seen.isZero(0)) C -= seen * MatrixXd(MatrixXd(W * V).partialPivLu().solve(W));
}

/// `dependent`: the states to eliminate, which the caller may know better than from W.
void remove(StateSpace& m, LeavingSides l, const std::vector<int>& dependent,
            std::vector<std::string>& notes) {
  if (const MatrixXd& W = l.undriven.W; W.rows() > 0) {
    const std::vector<int> keep = others(m.A.rows(), dependent);
    notes.push_back(note_of_dependent(m, dependent));
    const MatrixXd T = solve_for(W, dependent, keep, l.scale, l.noise);
    drive_no_more(l, m.B);
    take_out_dependent(m, dependent, T);
    LeavingModes& next = l.unseen;
    next.W = (next.W(Eigen::all, keep) + next.W(Eigen::all, dependent) * T).eval();
    next.V = next.V(keep, Eigen::all).eval();
    l.scale = l.scale(keep).eval();
  }
  if (const MatrixXd& V = l.unseen.V; V.cols() > 0) {
    const std::vector<int> out = pivots(V.transpose() * l.scale.cwiseInverse().asDiagonal());
    notes.push_back(note_of_unseen(m, out));
    see_no_more(l, m.C);
    take_out_unseen(
        m, out,
        solve_for(V.transpose(), out, others(m.A.rows(), out), l.scale.cwiseInverse(), l.noise)
            .transpose());
  }
}

/// Modal input or output matrix of all modes.
template <class Matrix>
struct ModeVectors {
  Matrix vectors;  ///< modes x states
  VectorXd sizes;  ///< of the vectors, the states in units of their own
  Matrix ports;    ///< modes x ports
};

/// The vectors of the removed modes. Rounding has mixed kept modes into them, the more the closer
/// their frequencies: a share of these is subtracted that makes the removed ones exactly
/// unreachable (or unobservable), unless it is more than errors of size `noise` in the matrix
/// explain, as for modes that the caller's resolution drops.
template <class Matrix>
Matrix leaving(const ModeVectors<Matrix>& all, const std::vector<Index>& leave,
               const std::vector<Index>& stay, const ModeSet& m, double noise) {
  const VectorXd unit = all.sizes.cwiseInverse();
  const Matrix vectors = unit.asDiagonal() * all.vectors;
  Matrix result = vectors(leave, Eigen::all), ports = unit.asDiagonal() * all.ports;
  if (stay.empty() || ports.cols() == 0) return result;
  for (Index l = 0; l < ports.cols(); ++l)
    if (const double size = ports(stay, l).norm(); size > 0) ports.col(l) /= size;
  for (std::size_t k = 0; k < leave.size(); ++k) {
    const Index j = leave[k];
    // Effect of a share of mode i on the equation of mode j: the smallest solution. Modes of one
    // cluster have been rotated already.
    VectorXd inverse = m.distance(stay, j).cwiseMax(kEpsilon * noise).cwiseInverse();
    for (std::size_t i = 0; i < stay.size(); ++i)
      if (m.cluster[at(stay[i])] == m.cluster[at(j)]) inverse(static_cast<Index>(i)) = 0;
    // A port at rounding level gives no condition.
    std::vector<Index> clear;
    for (Index l = 0; l < ports.cols(); ++l)
      if (std::abs(ports(j, l)) <= kSmallShare) clear.push_back(l);
    if (clear.empty() || ports(j, clear).norm() <= kEpsilon) continue;
    const Matrix moved = (inverse.asDiagonal() * ports(stay, clear)).transpose();
    const Matrix shown = -ports(j, clear).transpose();
    const Matrix error = moved.completeOrthogonalDecomposition().solve(shown);
    const Matrix share = inverse.asDiagonal() * error;
    if (error.norm() <= noise && share.norm() <= kSmallShare)
      result.row(static_cast<Index>(k)) += share.transpose() * vectors(stay, Eigen::all);
  }
  return result;
}

/// Modes that may have a share in the removed ones: not their conjugate partners, and none at 0,
/// which are far away.
std::vector<Index> staying(const ModeSet& m, const std::vector<Index>& leave) {
  std::vector<Index> result;
  const auto leaves = [&](Index i) {
    return std::find(leave.begin(), leave.end(), i) != leave.end();
  };
  for (Index i = 0; i < m.size(); ++i) {
    const bool partner = m.states[at(i)] == 0 && leaves(i - 1);
    if (!leaves(i) && !partner && m.apart[at(i)].empty()) result.push_back(i);
  }
  return result;
}

/// Removed states of a cluster: orthonormal columns in its own coordinates.
void add(const MatrixXd& part, const WholeCluster& c, LeavingModes& to) {
  const Index before = to.W.rows(), k = part.cols();
  if (k == 0) return;
  to.W.conservativeResize(before + k, c.W.cols());
  to.W.bottomRows(k) = part.transpose() * c.W;
  to.V.conservativeResize(c.V.rows(), before + k);
  to.V.rightCols(k) = c.V * part;
}

/// Position and velocity level of the same relations (rows).
MatrixXd on_both(const MatrixXd& half, const Symmetric& s, Index states) {
  const Index k = half.rows();
  MatrixXd full = MatrixXd::Zero(2 * k, states);
  for (std::size_t i = 0; i < s.q.size(); ++i) {
    full.col(s.q[i]).head(k) = half.col(static_cast<Index>(i));
    full.col(s.qdot[i]).tail(k) = half.col(static_cast<Index>(i));
  }
  return full;
}

std::vector<int> both_levels(const std::vector<int>& coordinates, const Symmetric& s) {
  std::vector<int> states;
  for (const int i : coordinates) {
    states.push_back(s.q[at(i)]);
    states.push_back(s.qdot[at(i)]);
  }
  std::sort(states.begin(), states.end());
  return states;
}

}  // namespace

std::vector<int> others(Index states, const std::vector<int>& out) {
  std::vector<int> rest;
  for (int i = 0; i < states; ++i)
    if (!std::binary_search(out.begin(), out.end(), i)) rest.push_back(i);
  return rest;
}

std::string note_of_dependent(const StateSpace& m, const std::vector<int>& out) {
  return "states that follow from the others: " + names_of(m, out);
}

std::string note_of_unseen(const StateSpace& m, const std::vector<int>& out) {
  return "states that were subtracted from the others: " + names_of(m, out);
}

std::string names_of(const StateSpace& model, const std::vector<int>& states) {
  std::vector<std::string> names;
  for (const int i : states) names.push_back(model.states[at(i)]);
  return detail::some_names(names);
}

void take_out_dependent(StateSpace& m, const std::vector<int>& out, const MatrixXd& T) {
  const std::vector<int> keep = others(m.A.rows(), out);
  m.A = (m.A(keep, keep) + m.A(keep, out) * T).eval();
  m.C = (m.C(Eigen::all, keep) + m.C(Eigen::all, out) * T).eval();
  m.B = m.B(keep, Eigen::all).eval();
  keep_names(m, keep);
}

void take_out_unseen(StateSpace& m, const std::vector<int>& out, const MatrixXd& P) {
  const std::vector<int> keep = others(m.A.rows(), out);
  m.A = (m.A(keep, keep) + P * m.A(out, keep)).eval();
  m.B = (m.B(keep, Eigen::all) + P * m.B(out, Eigen::all)).eval();
  m.C = m.C(Eigen::all, keep).eval();
  keep_names(m, keep);
}

void take_out(const Symmetric& s, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes) {
  std::vector<Index> unreachable, unseen;
  for (Index j = 0; j < s.Q.cols(); ++j)
    if (verdicts[at(j)].drop) (verdicts[at(j)].unreachable ? unreachable : unseen).push_back(j);
  const Index states = model.A.rows();
  MatrixXd shown(2 * model.C.rows(), s.Q.rows());
  shown << model.C(Eigen::all, s.q) * s.D, model.C(Eigen::all, s.qdot) * s.D;
  const auto modes = [&](const MatrixXd& ports, const std::vector<Index>& leave) {
    const ModeVectors<MatrixXd> all{s.Q.transpose(), VectorXd::Ones(s.Q.cols()),
                                    s.Q.transpose() * ports};
    return leaving(all, leave, staying(s.modes, leave), s.modes,
                   linalg::kProductRounding * s.modes.lambda.maxCoeff());
  };
  const MatrixXd left = modes(s.D_inverse * model.B(s.qdot, Eigen::all), unreachable) * s.D_inverse;
  const MatrixXd right = s.D * modes(shown.transpose(), unseen).transpose();
  const auto levels = [&](const MatrixXd& half) { return on_both(half, s, states); };
  const auto motions = [&](const std::vector<Index>& of) { return s.D * s.Q(Eigen::all, of); };
  const auto coordinates = [&](const std::vector<Index>& of) {
    return s.Q(Eigen::all, of).transpose() * s.D_inverse;
  };
  // Energy weight: soft coordinates are chosen to depend on the others.
  const VectorXd weight = s.D_inverse.colwise().norm().cwiseInverse();
  LeavingSides l{{levels(left), levels(motions(unreachable).transpose()).transpose()},
                 {levels(coordinates(unseen)), levels(right.transpose()).transpose()},
                 VectorXd(states),
                 linalg::kProductRounding};
  for (std::size_t i = 0; i < s.q.size(); ++i)
    l.scale(s.q[i]) = l.scale(s.qdot[i]) = weight(static_cast<Index>(i));
  const std::vector<int> dependent =
      unreachable.empty() ? std::vector<int>{} : both_levels(pivots(left * weight.asDiagonal()), s);
  remove(model, std::move(l), dependent, notes);
}

void take_out(const General& g, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes) {
  const Index n = g.e.values.size();
  std::vector<Index> unreachable, unseen;
  for (Index j = 0; j < n; ++j)
    if (verdicts[at(j)].drop && g.modes.states[at(j)] > 0)
      (verdicts[at(j)].unreachable ? unreachable : unseen).push_back(j);
  // A pair of poles by its real and imaginary part.
  const auto real_rows = [&](const MatrixXcd& rows, const std::vector<Index>& of) {
    MatrixXd result(0, n);
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Eigen::RowVectorXcd row = rows.row(static_cast<Index>(k));
      const bool pair = g.modes.states[at(of[k])] == 2;
      result.conservativeResize(result.rows() + (pair ? 2 : 1), n);
      result.row(result.rows() - 1) = row.imag();
      result.row(result.rows() - (pair ? 2 : 1)) = row.real();
    }
    return result;
  };
  const auto relations = [&](const MatrixXcd& vectors, const VectorXd& sizes,
                             const MatrixXcd& ports, const std::vector<Index>& leave) {
    return real_rows(
        leaving(ModeVectors<MatrixXcd>{vectors, sizes, ports}, leave, staying(g.modes, leave),
                g.modes, linalg::kProductRounding * g.modes.lambda.maxCoeff()),
        leave);
  };
  const VectorXd& scale = g.e.scale;
  const MatrixXcd V = g.e.V.transpose();
  const MatrixXd left = relations(g.e.W, (g.e.W * scale.asDiagonal()).rowwise().norm(),
                                  g.e.W * model.B, unreachable),
                 right = relations(V, (V * scale.cwiseInverse().asDiagonal()).rowwise().norm(),
                                   (model.C * g.e.V).transpose(), unseen);
  LeavingSides l{{left, real_rows(V(unreachable, Eigen::all), unreachable).transpose()},
                 {real_rows(g.e.W(unseen, Eigen::all), unseen), right.transpose()},
                 scale,
                 linalg::kSumsOfSums};
  for (const WholeCluster& c : g.modes.wholes) {
    add(c.part.unreachable, c, l.undriven);
    add(c.part.unseen, c, l.unseen);
  }
  const MatrixXd& relations_now = l.undriven.W;
  const std::vector<int> dependent =
      relations_now.rows() == 0 ? std::vector<int>{} : pivots(relations_now * scale.asDiagonal());
  remove(model, std::move(l), dependent, notes);
}

}  // namespace titop::minreal
