#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/graph/linalg/index.hpp>

/// Undamped and proportionally damped models.
namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using linalg::at;

/// Modes of one frequency are counted as equal if their dampings are equal, too. Sorts those of one
/// frequency by their damping z.
void find_clusters(GradedModes& e, VectorXd& z, double resolution, ModeSet& m) {
  VectorXd& lambda = e.modes.lambda;
  const Index n = lambda.size();
  // A frequency that differs by 2 * resolution differs by 4 * resolution in its square.
  const double same = std::max(linalg::kSameFrequency, 4 * resolution);
  m.cluster.assign(at(n), 0);
  for (const auto& [first, count] : equal_frequencies(e, same)) {
    std::vector<Index> order(at(count));
    std::iota(order.begin(), order.end(), first);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return z(a) < z(b); });
    e.modes.V.middleCols(first, count) = e.modes.V(Eigen::all, order).eval();
    lambda.segment(first, count) = lambda(order).eval();
    z.segment(first, count) = z(order).eval();
    for (Index i = std::max<Index>(first, 1); i < first + count; ++i) {
      const double own =
          std::max({std::sqrt(std::abs(lambda(i))), std::abs(z(i - 1)), std::abs(z(i))});
      const bool apart = i == first || z(i) - z(i - 1) > same * own;
      m.cluster[at(i)] = m.cluster[at(i - 1)] + (apart ? 1 : 0);
    }
  }
}

/// Inputs and outputs of a second-order model in its scaled coordinates.
struct CoordinatePorts {
  MatrixXd b, bq;   ///< coordinates x inputs: on the velocities, on the positions
  MatrixXd cq, cv;  ///< coordinates x outputs
};

CoordinatePorts ports(const StateSpace& model, const Symmetric& s) {
  return {s.D_inverse * model.B(s.qdot, Eigen::all), s.D_inverse * model.B(s.q, Eigen::all),
          (model.C(Eigen::all, s.q) * s.D).transpose(),
          (model.C(Eigen::all, s.qdot) * s.D).transpose()};
}

void turn_clusters(const CoordinatePorts& p, const ModeSet& m, MatrixXd& Q) {
  MatrixXd both(Q.rows(), p.cq.cols() + p.cv.cols());
  both << p.cq, p.cv;
  const MatrixXd b = unit_columns(MatrixXd(Q.transpose() * p.b)),
                 c = unit_columns(MatrixXd(Q.transpose() * both));
  for (Index first = 0, last; first < Q.cols(); first = last) {
    last = first + 1;
    while (last < Q.cols() && m.cluster[at(last)] == m.cluster[at(first)]) ++last;
    const Index k = last - first;
    if (k > 1)
      Q.middleCols(first, k) *=
          turn(MatrixXd(b.middleRows(first, k)), MatrixXd(c.middleRows(first, k)));
  }
}

/// Entries of Q'c that are above the rounding of their terms; 0 for the others.
MatrixXd clear(const MatrixXd& Q, const MatrixXd& c) {
  const MatrixXd in = Q.transpose() * c, terms = Q.cwiseAbs().transpose() * c.cwiseAbs();
  return (in.array().abs() <= linalg::kSumsOfSums * terms.array()).select(0, in);
}

/// An output that reads positions and rates, C = cq + s cv at each pole s, if that is more than
/// a factor to real vectors: one of the two poles of an overdamped mode may be left out, or a
/// motion with a phase between modes of one frequency.
bool mixes_levels(const GradedModes& e, const VectorXd& z, const CoordinatePorts& p,
                  const ModeSet& m) {
  const MatrixXd q = clear(e.modes.V, p.cq), v = clear(e.modes.V, p.cv);
  const Index n = z.size();
  for (Index first = 0, last; first < n; first = last) {
    for (last = first + 1; last < n && m.cluster[at(last)] == m.cluster[at(first)];) ++last;
    const double lambda = e.modes.lambda(first);
    const bool real = z(first) * z(first) >= 4 * lambda * (1 - linalg::kSameFrequency);
    for (Index k = 0; k < q.cols() && lambda != 0; ++k) {
      const VectorXd a = q.col(k).segment(first, last - first),
                     b = v.col(k).segment(first, last - first);
      const double size = a.norm() * b.norm();
      const double across = (a * b.transpose() - b * a.transpose()).norm();
      if (size > 0 && (real || across > kClearRank * size)) return true;
    }
  }
  return false;
}

/// Two modes that are not equal have a real pole in common.
bool shares_a_pole(const VectorXd& lambda, const VectorXd& z, const ModeSet& m) {
  std::vector<std::pair<double, int>> poles;  // and its cluster
  for (Index i = 0; i < z.size(); ++i) {
    const double root2 = z(i) * z(i) - 4 * lambda(i);
    if (lambda(i) == 0 || root2 < 0) continue;
    const double fast = (z(i) + std::copysign(std::sqrt(root2), z(i))) / 2;
    poles.emplace_back(fast, m.cluster[at(i)]);
    poles.emplace_back(lambda(i) / fast, m.cluster[at(i)]);
  }
  std::sort(poles.begin(), poles.end());
  return std::adjacent_find(poles.begin(), poles.end(), [](const auto& a, const auto& b) {
           return a.second != b.second &&
                  std::abs(b.first - a.first) <= linalg::kSameFrequency * std::abs(b.first);
         }) != poles.end();
}

/// Distance of modes (damping z counts by its shift of the pole), and mixing by rounding: small for
/// small modes of graded matrices.
void find_mixing(const GradedModes& e, const VectorXd& z, ModeSet& m) {
  const VectorXd& lambda = e.modes.lambda;
  const Index n = lambda.size();
  const double all_alike = std::sqrt(static_cast<double>(n)) * kEpsilon * m.lambda.maxCoeff();
  m.distance.resize(n, n);
  m.mixing.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const double omega = std::sqrt(std::max(m.lambda(i), m.lambda(j)));
      const double gap = std::hypot(lambda(i) - lambda(j), omega * (z(i) - z(j)));
      m.distance(i, j) = gap;
      const double graded = e.relative * std::sqrt(m.lambda(i) * m.lambda(j));
      const double rounding = e.graded ? std::min(all_alike, graded) : all_alike;
      m.mixing(i, j) = gap > 0 ? std::min(1.0, rounding / gap) : 1;
    }
}

/// Rigid motions, q'' = b u: all are needed if inputs move and outputs place each of them.
void find_rigid(const CoordinatePorts& p, const MatrixXd& Q, ModeSet& m) {
  const Index n = m.size();
  std::vector<Index> rigid;
  for (Index j = 0; j < n; ++j)
    if (m.lambda(j) == 0) rigid.push_back(j);
  m.apart.assign(at(n), "");
  m.needed.assign(at(n), 0);
  if (rigid.empty()) return;
  const auto all_in = [&](const MatrixXd& columns) {
    if (columns.cols() == 0) return true;
    const MatrixXd part = Q(Eigen::all, rigid).transpose() * unit_columns(columns);
    return part.rowwise().norm().minCoeff() > kClearRow && clearly_full_rank(part);
  };
  const bool needed = all_in(p.b) && all_in(p.cq);
  for (const Index j : rigid) m.apart[at(j)] = kAtZero, m.needed[at(j)] = needed;
}

}  // namespace

std::optional<Symmetric> symmetric_modes(const StateSpace& model, double resolution,
                                         const MatrixXd& energy) {
  SecondOrder form = second_order(model, energy);
  if (!form.found) return std::nullopt;
  Symmetric s;
  s.q = std::move(form.q), s.qdot = std::move(form.qdot);
  s.D = std::move(form.D), s.D_inverse = std::move(form.D_inverse);
  const CoordinatePorts p = ports(model, s);
  if (p.bq.size() && p.bq.cwiseAbs().maxCoeff() > 0) return std::nullopt;
  std::optional<ProportionalModes> proportional = proportional_modes(form);
  if (!proportional) return std::nullopt;
  auto& [e, z] = *proportional;
  ModeSet& m = s.modes;
  find_clusters(e, z, resolution, m);
  if (mixes_levels(e, z, p, m) || shares_a_pole(e.modes.lambda, z, m)) return std::nullopt;
  s.Q = e.modes.V;
  m.lambda = e.modes.lambda.cwiseAbs();
  const UncoupledParts parts = find_parts(form.S, s.Q.cwiseAbs(), m);
  keep_to_parts(parts, s.Q);
  turn_clusters(p, m, s.Q);
  m.omega = m.lambda.cwiseSqrt();
  m.states.assign(at(m.size()), 2);
  m.b = (s.Q.transpose() * p.b).cwiseAbs();
  const MatrixXd pq = s.Q.transpose() * p.cq, pv = m.omega.asDiagonal() * s.Q.transpose() * p.cv;
  m.c = (pq.array().square() + pv.array().square()).sqrt();
  balance_sides(parts, m);
  find_mixing(e, z, m);
  find_rigid(p, s.Q, m);
  return s;
}

}  // namespace titop::minreal
