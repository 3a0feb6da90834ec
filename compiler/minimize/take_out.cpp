#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <titop/compiler/minimize/take_out.hpp>

namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEps = std::numeric_limits<double>::epsilon();

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Columns that stand best for the rows of W (k x n): pivoted QR.
std::vector<int> pivots(const MatrixXd& W) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(W);
  std::vector<int> result;
  for (Index k = 0; k < W.rows(); ++k)
    result.push_back(static_cast<int>(qr.colsPermutation().indices()(k)));
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<int> others(Index n, const std::vector<int>& taken) {
  std::vector<int> rest;
  for (int i = 0; i < n; ++i)
    if (!std::binary_search(taken.begin(), taken.end(), i)) rest.push_back(i);
  return rest;
}

/// out = R keep on the span of the relations (rows W), with the states in units of `scale`:
/// coefficients that are only rounding there are 0, so that zeros of the model stay zeros.
MatrixXd solve_for(const MatrixXd& W, const std::vector<int>& out, const std::vector<int>& keep,
                   const VectorXd& scale, double noise) {
  const MatrixXd S = W * scale.asDiagonal();
  MatrixXd R = -S(Eigen::all, out).fullPivLu().solve(S(Eigen::all, keep));
  R = (R.array().abs() <= noise).select(0.0, R);
  return scale(out).asDiagonal() * R * scale(keep).cwiseInverse().asDiagonal();
}

void keep_names(StateSpace& m, const std::vector<int>& keep) {
  std::vector<std::string> names;
  for (const int i : keep) names.push_back(m.states[at(i)]);
  m.states = std::move(names);
}

std::string list(const std::vector<int>& out, const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < out.size() && i < 8; ++i) text += (i ? ", " : "") + names[at(out[i])];
  return out.size() > 8 ? text + fmt::format(", and {} more", out.size() - 8) : text;
}

/// What leaves a model: relations W x = 0 (rows) that hold for all that inputs can do, and motions
/// V (columns) that show in no output. `scale`: units of the states.
struct Leaving {
  MatrixXd W, V;
  VectorXd scale;
  double noise;
};

/// The states `out` follow from the others.
void remove_unreachable(StateSpace& m, Leaving& l, const std::vector<int>& out) {
  const std::vector<int> keep = others(m.A.rows(), out);
  const MatrixXd T_dep = solve_for(l.W, out, keep, l.scale, l.noise);
  const MatrixXd A = m.A(keep, keep) + m.A(keep, out) * T_dep;
  const MatrixXd C = m.C(Eigen::all, keep) + m.C(Eigen::all, out) * T_dep;
  m.B = m.B(keep, Eigen::all).eval();
  m.A = A;
  m.C = C;
  keep_names(m, keep);
  l.V = l.V(keep, Eigen::all).eval();
  l.scale = l.scale(keep).eval();
}

/// The others are taken relative to the states `out`.
void remove_unseen(StateSpace& m, const Leaving& l, const std::vector<int>& out) {
  const std::vector<int> keep = others(m.A.rows(), out);
  const MatrixXd P =
      solve_for(l.V.transpose(), out, keep, l.scale.cwiseInverse(), l.noise).transpose();
  const MatrixXd A = m.A(keep, keep) + P * m.A(out, keep);
  const MatrixXd B = m.B(keep, Eigen::all) + P * m.B(out, Eigen::all);
  m.A = A;
  m.B = B;
  m.C = m.C(Eigen::all, keep).eval();
  keep_names(m, keep);
}

/// `dependent`: the states that follow, where the caller knows better than W alone.
void remove(StateSpace& m, Leaving l, const std::vector<int>& dependent,
            std::vector<std::string>& notes) {
  if (l.W.rows() > 0) {
    notes.push_back("states that follow from the others: " + list(dependent, m.states));
    remove_unreachable(m, l, dependent);
  }
  if (l.V.cols() > 0) {
    const std::vector<int> out = pivots(l.V.transpose());
    notes.push_back("states that the others are now taken relative to: " + list(out, m.states));
    remove_unseen(m, l, out);
  }
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

void take_out(const Symmetric& s, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes) {
  std::vector<Index> unreachable, unseen;
  for (Index j = 0; j < s.Q.cols(); ++j)
    if (verdicts[at(j)].drop) (verdicts[at(j)].unreachable ? unreachable : unseen).push_back(j);
  const Index states = model.A.rows();
  const MatrixXd left = s.Q(Eigen::all, unreachable).transpose() * s.D_inverse;
  const MatrixXd right = s.D * s.Q(Eigen::all, unseen);
  // Energy weight: soft coordinates are chosen to depend on the others.
  const VectorXd weight = s.D_inverse.colwise().norm().cwiseInverse();
  Leaving l{on_both(left, s, states), on_both(right.transpose(), s, states).transpose(),
            VectorXd(states), 64 * kEps};
  for (std::size_t i = 0; i < s.q.size(); ++i)
    l.scale(s.q[i]) = l.scale(s.qdot[i]) = weight(static_cast<Index>(i));
  const std::vector<int> dependent =
      unreachable.empty() ? std::vector<int>{} : both_levels(pivots(left * weight.asDiagonal()), s);
  remove(model, std::move(l), dependent, notes);
}

void take_out(const General& g, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes) {
  const Index n = g.e.values.size();
  std::vector<Eigen::RowVectorXd> left, right;
  for (Index j = 0; j < n; ++j) {
    const Verdict& v = verdicts[at(j)];
    if (!v.drop || g.modes.states[at(j)] == 0) continue;
    const Eigen::RowVectorXcd row =
        v.unreachable ? Eigen::RowVectorXcd(g.e.W.row(j)) : g.e.V.col(j).transpose();
    auto& list = v.unreachable ? left : right;
    list.push_back(row.real());
    if (g.modes.states[at(j)] == 2) list.push_back(row.imag());
  }
  const auto stack = [n](const std::vector<Eigen::RowVectorXd>& rows) {
    MatrixXd m(static_cast<Index>(rows.size()), n);
    for (std::size_t i = 0; i < rows.size(); ++i) m.row(static_cast<Index>(i)) = rows[i];
    return m;
  };
  Leaving l{stack(left), stack(right).transpose(), g.e.scale, 1e-12};
  const std::vector<int> dependent =
      left.empty() ? std::vector<int>{} : pivots(l.W * l.scale.asDiagonal());
  remove(model, std::move(l), dependent, notes);
}

}  // namespace titop::modes
