#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <titop/compiler/minimize/clusters.hpp>
#include <titop/graph/linalg/eigen.hpp>

/// Models of any other kind: eigenvalues with left and right vectors.
namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Eigenvalues that rounding has made a complex pair become two real ones; their vectors stay a
/// basis of the same plane.
void make_real(linalg::Eigensystem& e, double noise) {
  for (Index j = 0; j + 1 < e.values.size(); ++j) {
    if (!(e.values(j).imag() > 0) || e.values(j).imag() > noise) continue;
    e.values(j) = e.values(j + 1) = e.values(j).real();
    const Eigen::VectorXcd v = e.V.col(j);
    const Eigen::RowVectorXcd w = e.W.row(j);
    e.V.col(j) = v.real();
    e.V.col(j + 1) = v.imag();
    e.W.row(j) = 2 * w.real();
    e.W.row(j + 1) = -2 * w.imag();
  }
}

/// Left and right vectors of one norm in the states' own sizes, whatever their units; real ones of
/// real poles.
void normalize(linalg::Eigensystem& e) {
  for (Index j = 0; j < e.values.size(); ++j) {
    if (e.values(j).imag() == 0) e.W.row(j) = e.W.row(j).real().eval();
    const double right = e.V.col(j).cwiseQuotient(e.scale).norm(),
                 left = (e.W.row(j).transpose().cwiseProduct(e.scale)).norm();
    const double factor = std::sqrt(left) / std::sqrt(right);
    if (!(factor > 0) || !std::isfinite(factor)) continue;  // no basis: judged ill-conditioned
    e.V.col(j) *= factor;
    e.W.row(j) /= factor;
  }
}

/// Numbers the clusters: chains of eigenvalues of the upper half plane (and the axis) with gaps up
/// to what counts as equal. O(n^2).
void find_clusters(const linalg::Eigensystem& e, double noise, double resolution, ModeSet& m) {
  const Index n = e.values.size();
  m.cluster.assign(at(n), -1);
  int count = 0;
  for (Index first = 0; first < n; ++first) {
    if (m.cluster[at(first)] >= 0) continue;
    m.cluster[at(first)] = count;
    std::vector<Index> open{first};
    while (!open.empty()) {
      const Index i = open.back();
      open.pop_back();
      for (Index j = 0; j < n; ++j) {
        const double same =
            noise + std::max(kSameFrequency, 2 * resolution) * std::abs(e.values(i));
        if (m.cluster[at(j)] < 0 && std::abs(e.values(i) - e.values(j)) <= same)
          m.cluster[at(j)] = count, open.push_back(j);
      }
    }
    ++count;
  }
}

/// Members of each cluster.
std::vector<std::vector<Index>> clusters(const ModeSet& m) {
  std::vector<std::vector<Index>> members(at(m.size()));
  for (Index j = 0; j < m.size(); ++j) members[at(m.cluster[at(j)])].push_back(j);
  while (!members.empty() && members.back().empty()) members.pop_back();
  return members;
}

/// The left vectors that go with the k poles `of` a cluster: those of the k nearest.
MatrixXcd nearest(const linalg::Eigensystem& left, const Eigen::VectorXcd& of) {
  std::vector<Index> by_distance(at(left.values.size()));
  std::iota(by_distance.begin(), by_distance.end(), 0);
  const auto distance = [&](Index i) { return (of.array() - left.values(i)).abs().minCoeff(); };
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [&](Index i, Index j) { return distance(i) < distance(j); });
  by_distance.resize(at(of.size()));
  return left.V(Eigen::all, by_distance).transpose();
}

/// Where the vectors of some poles are hardly a basis, as of a Jordan block, W = V^-1 loses digits
/// of all the others: each cluster gets its left vectors U from A' itself, W = (U V)^-1 U. Those of
/// a Jordan block, or of other poles by mistake, are normal to V: W is huge, or 0 if it is not
/// finite. O(n^3).
void sharpen_left(const MatrixXd& balanced, double noise, const ModeSet& m,
                  linalg::Eigensystem& e) {
  constexpr double kGood = 1e-4;  ///< rcond of a basis whose inverse will do
  if (e.rcond_V > kGood) return;
  linalg::Eigensystem left = linalg::eigensystem(
      balanced.transpose(), [](MatrixXd& A) -> VectorXd { return VectorXd::Ones(A.rows()); });
  make_real(left, noise);
  const MatrixXcd V = e.scale.cwiseInverse().asDiagonal() * e.V;
  for (const std::vector<Index>& members : clusters(m)) {
    const MatrixXcd U = nearest(left, e.values(members)), product = U * V(Eigen::all, members);
    const MatrixXcd W = Eigen::PartialPivLU<MatrixXcd>(product).solve(U);
    for (std::size_t k = 0; k < members.size(); ++k) {
      const Eigen::RowVectorXcd w =
          W.row(static_cast<Index>(k)) * e.scale.cwiseInverse().asDiagonal();
      e.W.row(members[k]).setZero();
      if (w.allFinite()) e.W.row(members[k]) = w;
    }
  }
  for (Index j = 0; j < e.values.size(); ++j)
    if (e.values(j).imag() > 0) e.W.row(j + 1) = e.W.row(j).conjugate();
}

constexpr double kIll = 1e6;  ///< condition number of an eigenvalue that is not judged

/// Condition numbers of the eigenvalues, the states in their own sizes; within a cluster the
/// largest counts for all: beside a Jordan block of the same pole no vector is a mode of its own.
VectorXd conditions(const linalg::Eigensystem& e, const ModeSet& m) {
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  VectorXd result(m.size());
  for (const std::vector<Index>& members : clusters(m)) {
    double worst = 0;
    for (const Index j : members) {
      const double own = left(j) * right(j);
      worst = std::max(worst, own > 0 ? own : std::numeric_limits<double>::infinity());
    }
    result(members).setConstant(worst);
  }
  return result;
}

/// First order: rounding of size eps |A| in A turns w_j by (w_j dA v_i) / (s_j - s_i) into w_i, and
/// v_i by as much into v_j.
void find_mixing(const linalg::Eigensystem& e, const VectorXd& left, const VectorXd& right,
                 double size, ModeSet& m) {
  const Index n = e.values.size();
  m.distance.resize(n, n);
  m.mixing.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const double gap = std::abs(e.values(i) - e.values(j));
      m.distance(i, j) = gap;
      const double noise = kEps * size * left(j) * right(i);
      m.mixing(i, j) = gap > 0 ? std::min(1.0, noise / gap) : 1;
    }
}

/// Poles at 0 and ill-conditioned ones: clusters or Jordan blocks, kept whole. `size`: of A, which
/// a Jordan block at 0 has without a pole of that size.
void set_apart(const VectorXd& condition, double size, ModeSet& m) {
  const Index n = m.size();
  const double largest = n ? std::max(m.lambda.maxCoeff(), size) : 0;
  m.apart.assign(at(n), "");
  m.needed.assign(at(n), 0);
  for (Index j = 0; j < n; ++j) {
    if (m.lambda(j) <= 1e9 * kEps * largest)
      m.apart[at(j)] = kAtZero;
    else if (!(condition(j) <= kIll))
      m.apart[at(j)] = "it is ill-conditioned, as multiple poles are";
  }
}

/// Modes that stand apart, part by part, and A on them in the basis that stands for their vectors:
/// upper triangular.
struct Apart {
  std::vector<Index> modes;
  MatrixXcd T;
};

/// Vectors of a Jordan block are hardly a basis, and may be none at all: modes that stand apart get
/// a Schur basis of what those that are judged leave of the space, P = 1 - V W. O(n^3).
Apart take_apart(const MatrixXd& balanced, const Parts& parts, const ModeSet& m,
                 linalg::Eigensystem& e) {
  Apart result;
  const MatrixXcd all_V = e.scale.cwiseInverse().asDiagonal() * e.V,
                  all_W = e.W * e.scale.asDiagonal();
  for (int part = 0; part < std::ssize(parts.of_state); ++part) {
    std::vector<Index> apart, judged, states;
    for (Index j = 0; j < m.size(); ++j) {
      if (parts.of_state[at(j)] == part) states.push_back(j);
      if (parts.of_mode[at(j)] == part) (m.apart[at(j)].empty() ? judged : apart).push_back(j);
    }
    const Index n = std::ssize(states), k = std::ssize(apart), before = result.T.rows();
    if (k == 0) continue;
    const MatrixXd P =
        MatrixXd::Identity(n, n) - (all_V(states, judged) * all_W(judged, states)).real();
    const MatrixXd Q =
        Eigen::ColPivHouseholderQR<MatrixXd>(P).householderQ() * MatrixXd::Identity(n, k);
    const MatrixXd A = Q.transpose() * balanced(states, states) * Q, dual = Q.transpose() * P;
    const Eigen::ComplexSchur<MatrixXcd> schur(MatrixXcd(A.cast<std::complex<double>>()));
    e.V(states, apart) = e.scale(states).asDiagonal() * (Q * schur.matrixU());
    e.W(apart, states) =
        (schur.matrixU().adjoint() * dual) * e.scale(states).cwiseInverse().asDiagonal();
    result.modes.insert(result.modes.end(), apart.begin(), apart.end());
    result.T.conservativeResizeLike(MatrixXcd::Zero(before + k, before + k));
    result.T.bottomRightCorner(k, k) = schur.matrixT();
  }
  return result;
}

/// First order again, of all modes together that stand apart: O(n apart ports) for each of the
/// others.
void find_apart(const StateSpace& model, const linalg::Eigensystem& e, const Apart& apart,
                const VectorXd& left, const VectorXd& right, double size, ModeSet& m) {
  const Index n = m.size();
  m.b_apart = MatrixXd::Zero(n, model.B.cols());
  m.c_apart = MatrixXd::Zero(n, model.C.rows());
  if (apart.modes.empty()) return;
  for (const Index j : apart.modes) m.mixing.row(j).setZero(), m.mixing.col(j).setZero();
  const MatrixXcd V = e.scale.cwiseInverse().asDiagonal() * e.V(Eigen::all, apart.modes),
                  W = (e.W(apart.modes, Eigen::all) * e.scale.asDiagonal()).transpose(),
                  b = e.W(apart.modes, Eigen::all) * model.B,
                  c = (model.C * e.V(Eigen::all, apart.modes)).transpose();
  const double noise = kEps * size;
  for (Index j = 0; j < n; ++j) {
    if (!m.apart[at(j)].empty()) continue;
    MatrixXcd by = -apart.T;
    by.diagonal().array() += e.values(j);
    for (Index i = 0; i < by.rows(); ++i)
      if (std::abs(by(i, i)) < noise) by(i, i) = noise;
    const MatrixXcd in = by.triangularView<Eigen::Upper>().solve(b),
                    out = by.transpose().triangularView<Eigen::Lower>().solve(c);
    m.b_apart.row(j) = noise * left(j) * (V * in).colwise().norm();
    m.c_apart.row(j) = noise * right(j) * (W * out).colwise().norm();
  }
}

/// What drives each mode and what it shows, and what rounding puts into that.
void measure(const StateSpace& model, const linalg::Eigensystem& e, const Apart& apart, double size,
             ModeSet& m) {
  m.b = (e.W * model.B).cwiseAbs();
  m.c = (model.C * e.V).transpose().cwiseAbs();
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  find_mixing(e, left, right, size, m);
  find_apart(model, e, apart, left, right, size, m);
}

/// What a cluster is turned by: its rows of b or c', each port against all of the judged modes `of`
/// the same part, and the norm of what rounding may have put there. `mixing`: of x members.
struct Rows {
  MatrixXcd rows;
  double rounding = 0;
};
Rows against_part(const MatrixXcd& all, const std::vector<Index>& members,
                  const std::vector<Index>& of, const MatrixXd& mixing, const MatrixXd& apart) {
  const MatrixXd sizes = all(of, Eigen::all).cwiseAbs();
  const VectorXd unit = sizes.colwise().norm().transpose().unaryExpr(
      [](double norm) { return norm > 0 ? 1 / norm : 0.0; });
  const MatrixXd noise = mixing.transpose() * sizes + apart(members, Eigen::all);
  return {all(members, Eigen::all) * unit.asDiagonal(), (noise * unit.asDiagonal()).norm()};
}

void turn_cluster(const StateSpace& model, const Parts& parts, const std::vector<Index>& members,
                  const ModeSet& m, linalg::Eigensystem& e) {
  std::vector<Index> of;
  for (Index i = 0; i < m.size(); ++i)
    if (m.apart[at(i)].empty() && parts.of_mode[at(i)] == parts.of_mode[at(members[0])])
      of.push_back(i);
  MatrixXd into = m.mixing(of, members), from = m.mixing(members, of).transpose();
  for (Index i = 0; i < std::ssize(of); ++i)
    if (m.cluster[at(of[at(i)])] == m.cluster[at(members[0])])
      into.row(i).setConstant(2 * kEps), from.row(i).setConstant(2 * kEps);
  const Rows b = against_part(e.W * model.B, members, of, into, m.b_apart),
             c = against_part((model.C * e.V).adjoint(), members, of, from, m.c_apart);
  const MatrixXcd U = e.values(members[0]).imag() == 0
                          ? turn(MatrixXd(b.rows.real()), MatrixXd(c.rows.real()), b.rounding)
                          : turn(b.rows, c.rows, b.rounding);
  e.V(Eigen::all, members) = (e.V(Eigen::all, members) * U).eval();
  e.W(members, Eigen::all) = (U.adjoint() * e.W(members, Eigen::all)).eval();
}

/// Clusters that are judged; of a pair of them, one and its conjugate. False where there is none.
bool turn_clusters(const StateSpace& model, const Parts& parts, const ModeSet& m,
                   linalg::Eigensystem& e) {
  bool any = false;
  for (const std::vector<Index>& members : clusters(m)) {
    const auto all = [&](const auto& holds) {
      return std::all_of(members.begin(), members.end(), holds);
    };
    const bool judged = all([&](Index j) { return m.apart[at(j)].empty(); }),
               real = all([&](Index j) { return e.values(j).imag() == 0; }),
               upper = all([&](Index j) { return e.values(j).imag() > 0; });
    if (members.size() < 2 || !judged || !(real || upper)) continue;
    turn_cluster(model, parts, members, m, e);
    any = true;
    for (const Index j : members) {
      if (real) continue;
      e.V.col(j + 1) = e.V.col(j).conjugate();
      e.W.row(j + 1) = e.W.row(j).conjugate();
    }
  }
  return any;
}

/// Poles at 0 are needed if [A, B] and [A', C'] have full rank. A, B, C: balanced.
void find_needed(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, ModeSet& m) {
  if (std::find(m.apart.begin(), m.apart.end(), kAtZero) == m.apart.end()) return;
  const auto full = [](const MatrixXd& a, const MatrixXd& b) {
    if (b.cols() == 0) return true;
    MatrixXd both(a.rows(), a.cols() + b.cols());
    const double size = a.rowwise().norm().maxCoeff();
    both << a, (size > 0 ? size : 1) * unit_columns(b);
    return clearly_full_rank(both);
  };
  const bool needed = full(A, B) && full(A.transpose(), C.transpose());
  for (std::size_t j = 0; j < m.apart.size(); ++j) m.needed[j] = needed && m.apart[j] == kAtZero;
}

}  // namespace

General general_modes(const StateSpace& model, double resolution) {
  General g{linalg::eigensystem(model.A, linalg::balance_parts), {}};
  linalg::Eigensystem& e = g.e;
  ModeSet& m = g.modes;
  const MatrixXd balanced = e.scale.cwiseInverse().asDiagonal() * model.A * e.scale.asDiagonal();
  const double size = balanced.norm(), noise = 100 * kEps * size;
  make_real(e, noise);
  m.lambda = m.omega = e.values.cwiseAbs();
  find_clusters(e, noise, resolution, m);
  sharpen_left(balanced, noise, m, e);
  normalize(e);
  for (Index j = 0; j < m.size(); ++j)
    m.states.push_back(e.values(j).imag() > 0 ? 2 : e.values(j).imag() < 0 ? 0 : 1);
  const MatrixXd right_sizes = (e.scale.cwiseInverse().asDiagonal() * e.V).cwiseAbs(),
                 left_sizes = (e.W * e.scale.asDiagonal()).cwiseAbs().transpose();
  const Parts parts =
      find_parts(model.A, unit_columns(right_sizes).cwiseMax(unit_columns(left_sizes)), m);
  keep_to_parts(parts, e.V);
  keep_to_parts(parts, e.W.transpose());
  set_apart(conditions(e, m), size, m);
  const Apart apart = take_apart(balanced, parts, m, e);
  measure(model, e, apart, size, m);
  if (turn_clusters(model, parts, m, e)) measure(model, e, apart, size, m);
  balance_sides(parts, m);
  find_needed(balanced, e.scale.cwiseInverse().asDiagonal() * model.B,
              model.C * e.scale.asDiagonal(), m);
  return g;
}

}  // namespace titop::modes
