#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/modal.hpp>
#include <titop/compiler/name_order.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/graded.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNothing = 1e-17;  ///< far narrower than the spacing of doubles at a pole
constexpr double kDoubtful = 1e-9;  ///< above it a mode always stays

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Modes of one model: sizes of what drives them (rows b) and of what they show (columns c), and
/// the real vectors that span them on the states.
struct ModeSet {
  VectorXd lambda;                ///< of each mode: omega^2, or |s|
  MatrixXd b, c;                  ///< modes x nu, ny x modes: magnitudes
  std::vector<int> cluster;       ///< modes of one frequency share a number
  MatrixXd distance;              ///< |lambda_i - lambda_j|
  MatrixXd mixing;                ///< e_ij: how much of mode i rounding may put into mode j
  std::vector<char> untouchable;  ///< frequency 0, or ill-conditioned
};

/// Relative weight of one mode's row or column against what all modes do near its frequency.
double against_background(const MatrixXd& rows, const ModeSet& m, Index j, const VectorXd& mine) {
  double most = 0;
  for (Index l = 0; l < rows.cols(); ++l) {
    double q2 = 0;
    // The rows of a Jordan block may have any size: beside them everything would look like nothing.
    for (Index i = 0; i < rows.rows(); ++i)
      if (!m.untouchable[at(i)])
        q2 += rows(i, l) * rows(i, l) / std::max(m.distance(i, j), 0.01 * m.lambda(j));
    if (q2 > 0) most = std::max(most, mine(l) / std::sqrt(q2));
  }
  return most;
}

struct Verdict {
  double visibility = 1, bound = 0;
  bool unreachable = false;  ///< the weak side is the inputs' (else the outputs')
  bool drop = false;
};

/// Rounding's part in a row: what the other modes may have put into it.
VectorXd rounding(const MatrixXd& rows, const ModeSet& m, Index j) {
  VectorXd sum = VectorXd::Zero(rows.cols());
  for (Index i = 0; i < rows.rows(); ++i)
    if (m.cluster[at(i)] != m.cluster[at(j)] || i == j)
      sum += (i == j ? kEps : m.mixing(i, j)) * rows.row(i).transpose();
  return sum;
}

Verdict judge(const ModeSet& m, Index j, double resolution) {
  Verdict v;
  if (m.untouchable[at(j)]) return v;
  const MatrixXd ct = m.c.transpose();
  const bool inputs = m.b.cols() > 0, outputs = m.c.rows() > 0;
  const double beta = inputs ? against_background(m.b, m, j, m.b.row(j)) : 1;
  const double gamma = outputs ? against_background(ct, m, j, ct.row(j)) : 1;
  const double dbeta = inputs ? against_background(m.b, m, j, rounding(m.b, m, j)) : 0;
  const double dgamma = outputs ? against_background(ct, m, j, rounding(ct, m, j)) : 0;
  const double scale =
      (inputs ? 1 : std::sqrt(m.lambda(j))) * (outputs ? 1 : std::sqrt(m.lambda(j)));
  v.visibility = beta * gamma * scale / (2 * m.lambda(j));
  v.bound = std::max(gamma * dbeta, beta * dgamma) * scale / (2 * m.lambda(j));
  v.unreachable = inputs && (!outputs || beta <= gamma);
  v.drop = (v.visibility <= 10 * v.bound && v.visibility <= kDoubtful) ||
           v.visibility <= kNothing || v.visibility <= resolution;
  return v;
}

// --- undamped and proportionally damped models --------------------------------------------------

struct Symmetric {
  SecondOrder form;
  ModeSet modes;
  MatrixXd Q;  ///< eigenvectors in the scaled coordinates
};

void find_clusters(const VectorXd& lambda, ModeSet& m) {
  m.cluster.assign(at(lambda.size()), 0);
  const double largest = lambda.size() ? lambda.cwiseAbs().maxCoeff() : 0;
  for (Index i = 1; i < lambda.size(); ++i) {
    const double noise = 100 * kEps * largest + 1e-9 * std::abs(lambda(i));
    m.cluster[at(i)] = m.cluster[at(i - 1)] + (lambda(i) - lambda(i - 1) > noise ? 1 : 0);
  }
}

/// Turns the modes of each cluster among themselves: first those that no input moves, then, among
/// the others, those that no output sees. Rows of b and columns of c stand with unit weight each.
void turn_clusters(Symmetric& s, const MatrixXd& b, const MatrixXd& c) {
  const auto unit = [](MatrixXd m) {
    for (Index l = 0; l < m.cols(); ++l)
      if (const double n = m.col(l).norm(); n > 0) m.col(l) /= n;
    return m;
  };
  const MatrixXd bu = unit(s.Q.transpose() * b), cu = unit(s.Q.transpose() * c);
  for (Index first = 0, last; first < s.Q.cols(); first = last) {
    last = first + 1;
    while (last < s.Q.cols() && s.modes.cluster[at(last)] == s.modes.cluster[at(first)]) ++last;
    const Index k = last - first;
    if (k == 1) continue;
    MatrixXd turn = MatrixXd::Identity(k, k);
    Index reached = k;
    if (bu.cols() > 0) {
      const Eigen::JacobiSVD<MatrixXd> svd(bu.middleRows(first, k), Eigen::ComputeFullU);
      turn = svd.matrixU();
      const VectorXd& sigma = svd.singularValues();
      reached = 0;
      while (reached < sigma.size() && sigma(reached) > 1e-8 * sigma(0)) ++reached;
    }
    if (cu.cols() > 0 && reached > 1) {
      const MatrixXd seen = turn.leftCols(reached).transpose() * cu.middleRows(first, k);
      const Eigen::JacobiSVD<MatrixXd> svd(seen, Eigen::ComputeFullU);
      turn.leftCols(reached) = (turn.leftCols(reached) * svd.matrixU()).eval();
    }
    s.Q.middleCols(first, k) = (s.Q.middleCols(first, k) * turn).eval();
  }
}

/// Mode shapes, b and c of a second-order model; false if it is none.
bool symmetric_modes(const StateSpace& model, Symmetric& s) {
  s.form = second_order(model.A);
  if (!s.form.found) return false;
  const Index n = static_cast<Index>(s.form.q.size());
  const Index nu = model.B.cols(), ny = model.C.rows();
  MatrixXd b(n, nu), bq(n, nu), cq(ny, n), cv(ny, n);
  for (Index i = 0; i < n; ++i) {
    bq.row(i) = model.B.row(s.form.q[at(i)]);
    b.row(i) = model.B.row(s.form.qdot[at(i)]) / s.form.d(i);
    cq.col(i) = model.C.col(s.form.q[at(i)]) * s.form.d(i);
    cv.col(i) = model.C.col(s.form.qdot[at(i)]) * s.form.d(i);
  }
  if (bq.size() && bq.cwiseAbs().maxCoeff() > 0) return false;
  const SymmetricModes e = eigh_graded(s.form.S).modes;
  const MatrixXd Z = e.V.transpose() * s.form.Z * e.V;
  const MatrixXd off = Z - MatrixXd(Z.diagonal().asDiagonal());
  if (off.size() && off.cwiseAbs().maxCoeff() > 1e-12 * std::max(Z.cwiseAbs().maxCoeff(), 1e-300))
    return false;
  s.Q = e.V;
  find_clusters(e.lambda, s.modes);
  MatrixXd both(n, 2 * ny);
  both << cq.transpose(), cv.transpose();
  turn_clusters(s, b, both);
  ModeSet& m = s.modes;
  m.lambda = e.lambda.cwiseAbs();
  m.b = (s.Q.transpose() * b).cwiseAbs();
  const MatrixXd pq = cq * s.Q, pv = cv * s.Q * m.lambda.cwiseSqrt().asDiagonal();
  m.c = (pq.array().square() + pv.array().square()).sqrt();
  const double largest = n ? m.lambda.maxCoeff() : 0, smallest = n ? m.lambda.minCoeff() : 0;
  m.distance.resize(n, n);
  m.mixing.resize(n, n);
  m.untouchable.assign(at(n), 0);
  for (Index j = 0; j < n; ++j) {
    m.untouchable[at(j)] = m.lambda(j) <= 1e-13 * largest;
    for (Index i = 0; i < n; ++i) {
      const double gap = std::abs(e.lambda(i) - e.lambda(j));
      m.distance(i, j) = gap;
      const double backward = largest / gap;
      const double graded = smallest > 0 ? m.lambda(i) * m.lambda(j) / (smallest * gap) : backward;
      m.mixing(i, j) =
          gap > 0
              ? std::min(1.0, std::sqrt(static_cast<double>(n)) * kEps * std::min(backward, graded))
              : 1;
    }
  }
  return true;
}

// --- taking modes out ---------------------------------------------------------------------------

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

/// Relations W x = 0 hold for all that inputs can do (W: k x n, real): k states follow from the
/// others and leave. V: right vectors still to be taken out, kept in step.
void remove_unreachable(StateSpace& m, const MatrixXd& W, const std::vector<int>& out,
                        const VectorXd& scale, double noise, MatrixXd* V) {
  const std::vector<int> keep = others(m.A.rows(), out);
  const MatrixXd T_dep = solve_for(W, out, keep, scale, noise);
  const MatrixXd A = m.A(keep, keep) + m.A(keep, out) * T_dep;
  const MatrixXd C = m.C(Eigen::all, keep) + m.C(Eigen::all, out) * T_dep;
  m.B = m.B(keep, Eigen::all).eval();
  m.A = A;
  m.C = C;
  std::vector<std::string> names;
  for (const int i : keep) names.push_back(m.states[at(i)]);
  m.states = std::move(names);
  if (V && V->cols() > 0) *V = (*V)(keep, Eigen::all).eval();
}

/// Motions in the span of V (n x k) show in no output: the others are taken relative to k states.
void remove_unseen(StateSpace& m, const MatrixXd& V, const std::vector<int>& out,
                   const VectorXd& scale, double noise) {
  const std::vector<int> keep = others(m.A.rows(), out);
  const MatrixXd P = solve_for(V.transpose(), out, keep, scale.cwiseInverse(), noise).transpose();
  const MatrixXd A = m.A(keep, keep) + P * m.A(out, keep);
  const MatrixXd B = m.B(keep, Eigen::all) + P * m.B(out, Eigen::all);
  m.A = A;
  m.B = B;
  m.C = m.C(Eigen::all, keep).eval();
  std::vector<std::string> names;
  for (const int i : keep) names.push_back(m.states[at(i)]);
  m.states = std::move(names);
}

/// Position and velocity level of the same relation.
MatrixXd on_both(const MatrixXd& half, const SecondOrder& form, Index states, bool left) {
  const Index k = left ? half.rows() : half.cols();
  MatrixXd full = left ? MatrixXd::Zero(2 * k, states) : MatrixXd::Zero(states, 2 * k);
  for (std::size_t i = 0; i < form.q.size(); ++i) {
    const auto c = static_cast<Index>(i);
    if (left) {
      full.col(form.q[i]).head(k) = half.col(c);
      full.col(form.qdot[i]).tail(k) = half.col(c);
    } else {
      full.row(form.q[i]).head(k) = half.row(c);
      full.row(form.qdot[i]).tail(k) = half.row(c);
    }
  }
  return full;
}

std::vector<int> both_levels(const std::vector<int>& coordinates, const SecondOrder& form) {
  std::vector<int> states;
  for (const int i : coordinates) {
    states.push_back(form.q[at(i)]);
    states.push_back(form.qdot[at(i)]);
  }
  std::sort(states.begin(), states.end());
  return states;
}

/// Sums up the verdicts in the result; true if there is something to take out.
bool tally(const std::vector<Verdict>& verdicts, const ModeSet& m, int states_per_mode,
           Minimized& r) {
  int dropped = 0, unseen = 0, doubtful = 0;
  for (std::size_t j = 0; j < verdicts.size(); ++j) {
    const Verdict& v = verdicts[j];
    if (v.drop) {
      ++dropped;
      unseen += v.unreachable ? 0 : 1;
      r.largest_removed = std::max(r.largest_removed, v.visibility);
    } else if (!m.untouchable[j]) {
      r.smallest_kept = std::min(r.smallest_kept, v.visibility);
      if (v.visibility <= kDoubtful && v.visibility <= 1e4 * std::max(v.bound, kEps * kEps))
        ++doubtful;
    }
  }
  r.removed = dropped * states_per_mode;
  r.undecided = doubtful > 0;
  const auto order = static_cast<int>(r.model.A.rows());
  if (dropped > 0)
    r.notes.push_back(fmt::format(
        "{} of {} states: {} modes that no input moves, {} that no output sees; largest visibility "
        "removed {:.1e}, smallest kept {:.1e}",
        r.removed, order, dropped - unseen, unseen, r.largest_removed, r.smallest_kept));
  if (doubtful > 0)
    r.notes.push_back(fmt::format("undecided at this precision: order between {} and {}",
                                  order - r.removed - doubtful * states_per_mode,
                                  order - r.removed));
  return dropped > 0;
}

std::string list(const std::vector<int>& out, const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < out.size() && i < 8; ++i) text += (i ? ", " : "") + names[at(out[i])];
  return out.size() > 8 ? text + fmt::format(", and {} more", out.size() - 8) : text;
}

void minimize_symmetric(const Symmetric& s, double resolution, Minimized& r) {
  const Index n = s.Q.cols();
  std::vector<Verdict> verdicts;
  std::vector<Index> unreachable, unseen;
  for (Index j = 0; j < n; ++j) {
    verdicts.push_back(judge(s.modes, j, resolution));
    if (verdicts.back().drop) (verdicts.back().unreachable ? unreachable : unseen).push_back(j);
  }
  if (!tally(verdicts, s.modes, 2, r)) return;
  const Index states = r.model.A.rows();
  VectorXd scale(states);
  for (std::size_t i = 0; i < s.form.q.size(); ++i)
    scale(s.form.q[i]) = scale(s.form.qdot[i]) = s.form.d(static_cast<Index>(i));
  MatrixXd V = on_both(s.form.d.asDiagonal() * s.Q(Eigen::all, unseen), s.form, states, false);
  if (!unreachable.empty()) {
    // Energy weight: the scaled coordinates; soft ones are chosen to depend on the others.
    const MatrixXd left = s.Q(Eigen::all, unreachable).transpose();
    const MatrixXd W = left * s.form.d.cwiseInverse().asDiagonal();
    const std::vector<int> out = both_levels(pivots(left), s.form);
    r.notes.push_back("states that follow from the others: " + list(out, r.model.states));
    remove_unreachable(r.model, on_both(W, s.form, states, true), out, scale, 64 * kEps, &V);
    scale = scale(others(states, out)).eval();
  }
  if (!unseen.empty()) {
    const std::vector<int> out = pivots(V.transpose());
    r.notes.push_back("states that the others are now taken relative to: " +
                      list(out, r.model.states));
    remove_unseen(r.model, V, out, scale, 64 * kEps);
  }
}

// --- everything else ----------------------------------------------------------------------------

void minimize_general(double resolution, Minimized& r) {
  const linalg::Eigensystem e = linalg::eigensystem(r.model.A);
  const Index n = e.values.size();
  ModeSet m;
  m.lambda = e.values.cwiseAbs();
  m.b = (e.W * r.model.B).cwiseAbs();
  m.c = (r.model.C * e.V).cwiseAbs();
  m.distance.resize(n, n);
  m.mixing = MatrixXd::Zero(n, n);
  m.untouchable.assign(at(n), 0);
  const double largest = n ? m.lambda.maxCoeff() : 0;
  for (Index j = 0; j < n; ++j) {
    m.cluster.push_back(static_cast<int>(j));
    // Left and right vectors nearly at right angles: a cluster or a Jordan block, kept whole.
    const double condition = e.W.row(j).norm();
    m.untouchable[at(j)] =
        m.lambda(j) <= 1e-7 * largest * kEps / 1e-16 || condition > 1e6 * e.V.col(j).norm();
    for (Index i = 0; i < n; ++i) m.distance(i, j) = std::abs(e.values(i) - e.values(j));
  }
  std::vector<Verdict> verdicts;
  MatrixXd W(0, n), V(n, 0);
  for (Index j = 0; j < n; ++j) {
    Verdict v = judge(m, j, resolution);
    v.drop = v.drop && v.visibility <= std::max(kNothing, resolution);
    verdicts.push_back(v);
    if (!v.drop || e.values(j).imag() < 0) continue;
    for (const bool imaginary : {false, true}) {
      if (imaginary && e.values(j).imag() == 0) continue;
      if (v.unreachable) {
        W.conservativeResize(W.rows() + 1, n);
        W.bottomRows(1) = imaginary ? MatrixXd(e.W.row(j).imag()) : MatrixXd(e.W.row(j).real());
      } else {
        V.conservativeResize(n, V.cols() + 1);
        V.rightCols(1) = imaginary ? MatrixXd(e.V.col(j).imag()) : MatrixXd(e.V.col(j).real());
      }
    }
  }
  if (!tally(verdicts, m, 1, r)) return;
  VectorXd scale = e.scale;
  if (W.rows() > 0) {
    const std::vector<int> out = pivots(W);
    r.notes.push_back("states that follow from the others: " + list(out, r.model.states));
    remove_unreachable(r.model, W, out, scale, 1e-12, &V);
    scale = scale(others(n, out)).eval();
  }
  if (V.cols() > 0) {
    const std::vector<int> out = pivots(V.transpose());
    r.notes.push_back("states that the others are now taken relative to: " +
                      list(out, r.model.states));
    remove_unseen(r.model, V, out, scale, 1e-12);
  }
}

Minimized minimize_as_it_stands(const StateSpace& model, const MinimizeOptions& options) {
  Minimized result;
  result.model = model;
  if (model.order() == 0 || (model.inputs.empty() && model.outputs.empty())) return result;
  Symmetric s;
  if (symmetric_modes(model, s))
    minimize_symmetric(s, options.resolution, result);
  else
    minimize_general(options.resolution, result);
  return result;
}

}  // namespace

Minimized minimize(const StateSpace& model, const MinimizeOptions& options) {
  // By name, so that the last bits do not depend on the order in which the diagram was written.
  const std::optional<NameOrder> order = name_order(model);
  if (!order) return minimize_as_it_stands(model, options);
  Minimized result = minimize_as_it_stands(by_name(model, *order), options);
  result.model = as_before(result.model, model.states, *order);
  return result;
}

}  // namespace titop
