#include <algorithm>
#include <cmath>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/pole_clusters.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

/// Models of any other kind: eigenvalues with left and right vectors.
namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// Scales left and right vectors to one norm in the states' own sizes, independent of units; bases
/// of clusters remain.
void normalize(const ModeSet& m, linalg::Eigensystem& e) {
  for (Index j = 0; j < e.values.size(); ++j) {
    if (!m.apart[at(j)].empty()) continue;
    const double right = e.V.col(j).cwiseQuotient(e.scale).norm(),
                 left = (e.W.row(j).transpose().cwiseProduct(e.scale)).norm();
    const double factor = std::sqrt(left) / std::sqrt(right);
    if (!(factor > 0) || !std::isfinite(factor)) continue;  // no basis: judged ill-conditioned
    e.V.col(j) *= factor;
    e.W.row(j) /= factor;
  }
}

/// Numbers the clusters: chains of eigenvalues of the upper half plane (and the axis) with gaps up
/// to the limit of equality, in addition to those judged as a whole. O(n^2).
void find_clusters(const linalg::Eigensystem& e, const std::vector<std::vector<Index>>& wholes,
                   double noise, double resolution, ModeSet& m) {
  const Index n = e.values.size();
  m.cluster.assign(at(n), -1);
  int count = 0;
  for (const std::vector<Index>& whole : wholes) {
    for (const Index j : whole) m.cluster[at(j)] = count;
    ++count;
  }
  for (Index first = 0; first < n; ++first) {
    if (m.cluster[at(first)] >= 0) continue;
    m.cluster[at(first)] = count;
    std::vector<Index> open{first};
    while (!open.empty()) {
      const Index i = open.back();
      open.pop_back();
      for (Index j = 0; j < n; ++j) {
        const double same =
            noise + std::max(linalg::kSameFrequency, 2 * resolution) * std::abs(e.values(i));
        if (m.cluster[at(j)] < 0 && std::abs(e.values(i) - e.values(j)) <= same)
          m.cluster[at(j)] = count, open.push_back(j);
      }
    }
    ++count;
  }
}

/// Turns the modes of clusters whose poles have separate vectors.
void turn_clusters(const StateSpace& model, const ModeSet& m, linalg::Eigensystem& e) {
  const Index n = e.values.size();
  for (Index first = 0; first < n; ++first) {
    std::vector<Index> members, partners;
    bool real = false, complex = false;
    for (Index j = 0; j < n; ++j) {
      if (m.cluster[at(j)] != m.cluster[at(first)] || e.values(j).imag() < 0) continue;
      members.push_back(j);
      if (e.values(j).imag() > 0) partners.push_back(j + 1);
      (e.values(j).imag() > 0 ? complex : real) = true;
    }
    if (members.size() < 2 || members.front() != first || (real && complex)) continue;
    if (!m.apart[at(first)].empty()) continue;
    const MatrixXcd b = unit_columns(MatrixXcd(e.W(members, Eigen::all) * model.B));
    const MatrixXcd c = unit_columns(MatrixXcd((model.C * e.V(Eigen::all, members)).adjoint()));
    const MatrixXcd U = turn(b, c);
    e.V(Eigen::all, members) = (e.V(Eigen::all, members) * U).eval();
    e.W(members, Eigen::all) = (U.adjoint() * e.W(members, Eigen::all)).eval();
    if (!complex) continue;
    e.V(Eigen::all, partners) = e.V(Eigen::all, members).conjugate().eval();
    e.W(partners, Eigen::all) = e.W(members, Eigen::all).conjugate().eval();
  }
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
      const double noise = kEpsilon * size * left(j) * right(i);
      m.mixing(i, j) = gap > 0 ? std::min(1.0, noise / gap) : 1;
    }
}

/// Judges clusters as a whole: their poles are no modes of their own.
void judge_wholes(const StateSpace& model, const PoleClusters& p, ModeSet& m) {
  m.apart.assign(at(m.size()), "");
  m.needed.assign(at(m.size()), 0);
  for (const std::vector<Index>& whole : p.clusters) {
    OwnModel own = own_model(p, whole, model);
    WholeCluster c{p.e.values(whole).cwiseAbs().mean(), minimal_part(own.model), std::move(own.V),
                   std::move(own.W)};
    const bool at_zero = Eigen::JacobiSVD<MatrixXd>(own.model.A).singularValues().minCoeff() <=
                         detail::kRoundingFactor * own.model.A_noise;
    if (at_zero) c.omega = 0;  // else rounding of a multiple pole
    c.name = at_zero ? kAtZero : "its poles are equal up to rounding";
    for (const Index j : whole) m.apart[at(j)] = c.name, m.states[at(j)] = 0;
    m.wholes.push_back(std::move(c));
  }
}

/// First order again, for all isolated modes (see `apart`) together: those of a Jordan block are
/// large and cancel. O(n^2 ports) for each mode.
void find_apart(const StateSpace& model, const PoleClusters& p, const VectorXd& left,
                const VectorXd& right, double size, ModeSet& m) {
  const linalg::Eigensystem& e = p.e;
  const Index n = m.size();
  m.b_apart = MatrixXd::Zero(n, model.B.cols());
  m.c_apart = MatrixXd::Zero(n, model.C.rows());
  std::vector<Index> apart;
  for (Index j = 0; j < n; ++j)
    if (!m.apart[at(j)].empty()) apart.push_back(j);
  if (apart.empty()) return;
  for (const Index j : apart) m.mixing.row(j).setZero(), m.mixing.col(j).setZero();
  const MatrixXcd V = e.scale.cwiseInverse().asDiagonal() * e.V(Eigen::all, apart),
                  W = e.W(apart, Eigen::all) * e.scale.asDiagonal(),
                  b = e.W(apart, Eigen::all) * model.B, c = model.C * e.V(Eigen::all, apart);
  const double noise = kEpsilon * size;
  for (Index j = 0; j < n; ++j) {
    if (!m.apart[at(j)].empty()) continue;
    MatrixXcd R = -p.T(apart, apart);
    R.diagonal().array() += e.values(j);
    const auto by = R.triangularView<Eigen::Upper>();
    m.b_apart.row(j) = noise * left(j) * (V * by.solve(b)).colwise().norm();
    m.c_apart.row(j) = noise * right(j) * (c * by.solve(W)).rowwise().norm().transpose();
  }
}

}  // namespace

General general_modes(const StateSpace& model, double resolution) {
  PoleClusters p = pole_clusters(model.A);
  General g;
  linalg::Eigensystem& e = p.e;
  ModeSet& m = g.modes;
  const MatrixXd scaled = e.scale.cwiseInverse().asDiagonal() * model.A * e.scale.asDiagonal();
  const double size = scaled.norm();
  m.lambda = m.omega = e.values.cwiseAbs();
  for (Index j = 0; j < m.size(); ++j)
    m.states.push_back(e.values(j).imag() > 0 ? 2 : e.values(j).imag() < 0 ? 0 : 1);
  judge_wholes(model, p, m);
  normalize(m, e);
  find_clusters(e, p.clusters, 100 * kEpsilon * size, resolution, m);
  const MatrixXd right_sizes = (e.scale.cwiseInverse().asDiagonal() * e.V).cwiseAbs(),
                 left_sizes = (e.W * e.scale.asDiagonal()).cwiseAbs().transpose();
  const UncoupledParts parts =
      find_parts(model.A, unit_columns(right_sizes).cwiseMax(unit_columns(left_sizes)), m);
  keep_to_parts(parts, e.V);
  keep_to_parts(parts, e.W.transpose());
  turn_clusters(model, m, e);
  m.b = (e.W * model.B).cwiseAbs();
  m.c = (model.C * e.V).transpose().cwiseAbs();
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  find_mixing(e, left, right, size, m);
  find_apart(model, p, left, right, size, m);
  balance_sides(parts, m);
  g.e = std::move(p.e);
  return g;
}

}  // namespace titop::minreal
