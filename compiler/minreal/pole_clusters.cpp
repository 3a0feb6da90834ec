#include <algorithm>
#include <cmath>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/pole_clusters.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/linalg/spectral.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;
using Indices = std::vector<Index>;

constexpr double kWidest = 1e-3;  ///< of a matrix's norm: spread of a multiple pole by rounding

struct PoleCluster {
  Indices poles;
  bool whole;     ///< judged as a whole
  double radius;  ///< by which rounding may have moved the poles of a multiple one
};

double condition(const PoleClusters& p, Index j) {
  return (p.e.W.row(j).transpose().cwiseProduct(p.e.scale)).norm() *
         p.e.V.col(j).cwiseQuotient(p.e.scale).norm();
}

/// The spectrum of one component into the whole's.
void add_component(const MatrixXd& scaled, const std::vector<int>& states, PoleClusters& p,
                   std::vector<PoleCluster>& clusters) {
  const Index first = std::ssize(p.component), n = std::ssize(states);
  const MatrixXd A = scaled(states, states);
  const linalg::Spectrum s = linalg::spectrum(A, kIll);
  Indices places(at(n));
  for (Index j = 0; j < n; ++j) places[at(j)] = first + j;
  const VectorXd scale = p.e.scale(states);
  p.e.values.segment(first, n) = s.values;
  p.e.V(states, places) = scale.asDiagonal() * s.V;
  p.e.W(places, states) = s.W * scale.cwiseInverse().asDiagonal();
  p.T(places, places) = s.T;
  p.component.resize(at(first + n), static_cast<int>(p.components.size()));
  p.components.push_back(states);
  p.size.push_back(A.norm());
  for (const auto& [begin, count, simple] : s.clusters) {
    PoleCluster c{{}, !simple, 0};
    const auto values = s.values.segment(begin, count);
    const std::complex<double> mean = values.mean();
    for (Index j = begin; j < begin + count; ++j) {
      c.poles.push_back(first + j);
      c.whole = c.whole || !(condition(p, first + j) <= kIll) ||
                detail::kWarn * std::abs(s.values(j)) <= kEpsilon * A.norm();
    }
    if (!simple) c.radius = std::min(kWidest * A.norm(), (values.array() - mean).abs().maxCoeff());
    clusters.push_back(std::move(c));
  }
}

/// True if poles of both may be the same one.
bool meet(const PoleClusters& p, const PoleCluster& a, const PoleCluster& b) {
  const auto size = [&](const PoleCluster& c) { return p.size[at(p.component[at(c.poles[0])])]; };
  const double same = linalg::kOneNumber * (size(a) + size(b)) + a.radius + b.radius;
  for (const Index i : a.poles)
    for (const Index j : b.poles)
      if (std::abs(p.e.values(i) - p.e.values(j)) <=
          same + linalg::kSameFrequency * std::abs(p.e.values(i)))
        return true;
  return false;
}

/// Clusters take in all that shares a pole with them.
void join(const PoleClusters& p, std::vector<PoleCluster>& clusters) {
  for (std::size_t a = 0; a < clusters.size(); ++a)
    for (std::size_t b = 0; clusters[a].whole && b < clusters.size(); ++b) {
      PoleCluster &one = clusters[a], &other = clusters[b];
      if (a == b || other.poles.empty() || one.poles.empty() || !meet(p, one, other)) continue;
      one.poles.insert(one.poles.end(), other.poles.begin(), other.poles.end());
      std::sort(one.poles.begin(), one.poles.end());
      one.radius = std::max(one.radius, other.radius);
      other.poles.clear();
      b = static_cast<std::size_t>(-1);  // once more from the first
    }
}

}  // namespace

PoleClusters pole_clusters(const MatrixXd& A) {
  const Index n = A.rows();
  PoleClusters p;
  MatrixXd scaled = A;
  p.e.scale = linalg::similarity_scaling_of_parts(scaled);
  p.e.values.resize(n);
  p.e.V = p.e.W = p.T = MatrixXcd::Zero(n, n);
  std::vector<PoleCluster> clusters;
  for (const std::vector<int>& states : linalg::uncoupled_parts(A))
    add_component(scaled, states, p, clusters);
  join(p, clusters);
  for (PoleCluster& c : clusters)
    if (c.whole && !c.poles.empty()) p.clusters.push_back(std::move(c.poles));
  return p;
}

namespace {

/// The poles of a component in and outside of a cluster.
struct ComponentSplit {
  Indices in, out;
  ComponentSplit(const PoleClusters& p, const Indices& cluster, int component) {
    for (Index j = 0; j < std::ssize(p.component); ++j) {
      if (p.component[at(j)] != component) continue;
      (std::binary_search(cluster.begin(), cluster.end(), j) ? in : out).push_back(j);
    }
  }
};

/// Orthonormal real columns that span as many complex ones, whose span is closed under conjugation.
MatrixXd real_basis(const MatrixXcd& V) {
  MatrixXd both(V.rows(), 2 * V.cols());
  both << V.real(), V.imag();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(both);
  return MatrixXd(qr.householderQ()).leftCols(V.cols());
}

/// A component's part of a cluster, in scaled states.
struct ClusterShare {
  Indices in, out, at_states;
  MatrixXd Q, W;                                                  ///< W Q = 1
  MatrixXcd V_in, W_in, V_out, W_out, T_in, T_out, G, G_inverse;  ///< V_in = Q G
  MatrixXd A, B, C;                                               ///< of the component
};

ClusterShare share(const PoleClusters& p, const Indices& cluster, int component,
                   const StateSpace& m) {
  const ComponentSplit split(p, cluster, component);
  ClusterShare s{split.in, split.out, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  if (s.in.empty()) return s;
  for (const int i : p.components[at(component)]) s.at_states.push_back(i);
  const VectorXd scale = p.e.scale(s.at_states), inverse = scale.cwiseInverse();
  s.A = inverse.asDiagonal() * m.A(s.at_states, s.at_states) * scale.asDiagonal();
  s.B = inverse.asDiagonal() * m.B(s.at_states, Eigen::all);
  s.C = m.C(Eigen::all, s.at_states) * scale.asDiagonal();
  s.V_in = inverse.asDiagonal() * p.e.V(s.at_states, s.in);
  s.V_out = inverse.asDiagonal() * p.e.V(s.at_states, s.out);
  s.W_in = p.e.W(s.in, s.at_states) * scale.asDiagonal();
  s.W_out = p.e.W(s.out, s.at_states) * scale.asDiagonal();
  s.T_in = p.T(s.in, s.in);
  s.T_out = p.T(s.out, s.out);
  s.Q = real_basis(s.V_in);
  s.G = s.Q.transpose() * s.V_in;
  s.G_inverse = s.W_in * s.Q;
  s.W = (s.G * s.W_in).real();
  return s;
}

/// First-order effect of an error E of A on the cluster's A, the columns of its B and rows of its
/// C.
VectorXd off(const ClusterShare& s, const MatrixXd& E) {
  const MatrixXcd X = linalg::sylvester(s.T_in, s.T_out, s.W_in * E * s.V_out),
                  Y = linalg::sylvester(s.T_out, s.T_in, -s.W_out * E * s.V_in);
  VectorXd all(1 + s.B.cols() + s.C.rows());
  all << (s.W * E * s.Q).norm(), (s.G * X * s.W_out * s.B).colwise().norm().transpose(),
      (s.C * s.V_out * Y * s.G_inverse).rowwise().norm();
  return all;
}

MatrixXd error_like(const MatrixXd& A, int sample) {
  detail::SteadyRandom random(sample);
  const double size = kEpsilon * A.norm() / std::sqrt(static_cast<double>(A.rows()));
  MatrixXd E(A.rows(), A.cols());
  for (Index j = 0; j < E.cols(); ++j)
    for (Index i = 0; i < E.rows(); ++i) E(i, j) = size * random.unit();
  return E;
}

/// Puts a component's part next to the earlier ones.
void add_share(const ClusterShare& s, OwnModel& own) {
  ClusterModel& m = own.model;
  const Index before = m.A.rows(), k = std::ssize(s.in);
  m.A.conservativeResize(before + k, before + k);
  m.A.bottomRows(k).setZero();
  m.A.rightCols(k).setZero();
  m.A.bottomRightCorner(k, k) = s.W * s.A * s.Q;
  m.B.conservativeResize(before + k, m.B_noise.size());
  m.B.bottomRows(k) = s.W * s.B;
  m.C.conservativeResize(m.C_noise.size(), before + k);
  m.C.rightCols(k) = s.C * s.Q;
  m.A_size = std::max(m.A_size, s.A.norm());
  m.B_size += s.B.colwise().norm().transpose();
  m.C_size += s.C.rowwise().norm();
  const VectorXd most =
      detail::largest_of_samples([&](int sample) { return off(s, error_like(s.A, sample + 1)); });
  const VectorXd of_B = kEpsilon * (s.W.cwiseAbs() * s.B.cwiseAbs()).colwise().norm().transpose(),
                 of_C = kEpsilon * (s.C.cwiseAbs() * s.Q.cwiseAbs()).rowwise().norm();
  m.A_noise += most(0);
  m.B_noise += most.segment(1, of_B.size()).cwiseMax(of_B);
  m.C_noise += most.tail(of_C.size()).cwiseMax(of_C);
}

}  // namespace

OwnModel own_model(const PoleClusters& p, const Indices& cluster, const StateSpace& model) {
  const Index n = model.A.rows(), nu = model.B.cols(), ny = model.C.rows();
  OwnModel own;
  own.V = MatrixXd::Zero(n, std::ssize(cluster));
  own.W = MatrixXd::Zero(std::ssize(cluster), n);
  own.model.B_noise = own.model.B_size = VectorXd::Zero(nu);
  own.model.C_noise = own.model.C_size = VectorXd::Zero(ny);
  own.model.B = MatrixXd(0, nu);
  own.model.C = MatrixXd(ny, 0);
  for (int c = 0; c < std::ssize(p.components); ++c) {
    const ClusterShare s = share(p, cluster, c, model);
    if (s.in.empty()) continue;
    const VectorXd scale = p.e.scale(s.at_states);
    Indices own_places;
    for (Index k = 0; k < std::ssize(s.in); ++k) own_places.push_back(own.model.A.rows() + k);
    own.V(s.at_states, own_places) = scale.asDiagonal() * s.Q;
    own.W(own_places, s.at_states) = s.W * scale.cwiseInverse().asDiagonal();
    add_share(s, own);
  }
  return own;
}

}  // namespace titop::minreal
