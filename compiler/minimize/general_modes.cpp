#include <algorithm>
#include <cmath>
#include <titop/compiler/minimize/clusters.hpp>
#include <titop/graph/linalg/index.hpp>

/// Models of any other kind: eigenvalues with left and right vectors.
namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// Where the vectors of some poles are hardly a basis, as of a Jordan block, W = V^-1 loses digits
/// of all the others: simple poles get their left vectors from A' itself.
void sharpen_left(const MatrixXd& balanced, linalg::Eigensystem& e) {
  constexpr double kGood = 1e-4;   ///< rcond of a basis whose inverse will do
  constexpr double kClear = 1e-6;  ///< of |A|: distance of a simple pole
  if (e.rcond_V > kGood) return;
  const linalg::Eigensystem left = linalg::eigensystem(
      balanced.transpose(), [](MatrixXd& A) -> VectorXd { return VectorXd::Ones(A.rows()); });
  const double clear = kClear * balanced.norm();
  for (Index j = 0; j < e.values.size(); ++j) {
    const VectorXd there = (left.values.array() - e.values(j)).abs(),
                   here = (e.values.array() - e.values(j)).abs();
    Index k = 0;
    there.minCoeff(&k);
    const bool simple = (here.array() < clear).count() == 1 && (there.array() < clear).count() == 1;
    const Eigen::RowVectorXcd w = left.V.col(k).transpose() *
                                  e.scale.cwiseInverse().cast<std::complex<double>>().asDiagonal();
    const std::complex<double> product = w * e.V.col(j);
    if (simple && std::abs(product) > 0) e.W.row(j) = w / product;
  }
}

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

/// Left and right vectors of one norm in the states' own sizes, whatever their units.
void normalize(linalg::Eigensystem& e) {
  for (Index j = 0; j < e.values.size(); ++j) {
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

constexpr double kIll = 1e6;  ///< condition number of an eigenvalue that is not judged

/// Condition numbers of the eigenvalues, the states in their own sizes; within a cluster the
/// largest counts for all: beside a Jordan block of the same pole no vector is a mode of its own.
VectorXd conditions(const linalg::Eigensystem& e, const ModeSet& m) {
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  const Index n = e.values.size();
  std::vector<double> worst(at(n), 0);
  for (Index j = 0; j < n; ++j) {
    const double own = left(j) * right(j);
    double& most = worst[at(m.cluster[at(j)])];
    if (!std::isnan(most)) most = own <= most ? most : own;  // not a number: stays one
  }
  return VectorXd::NullaryExpr(n, [&](Index j) { return worst[at(m.cluster[at(j)])]; });
}

/// Of the clusters that are well-conditioned.
void turn_clusters(const StateSpace& model, const ModeSet& m, const VectorXd& condition,
                   linalg::Eigensystem& e) {
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
    if (!(condition(first) <= kIll)) continue;
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

/// First order again, of all modes together that stand apart: those of a Jordan block are large and
/// cancel. O(n^2 ports) for each of them.
void find_apart(const StateSpace& model, const linalg::Eigensystem& e, const VectorXd& left,
                const VectorXd& right, double size, ModeSet& m) {
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
  const double noise = kEps * size;
  for (Index j = 0; j < n; ++j) {
    if (!m.apart[at(j)].empty()) continue;
    const Eigen::VectorXcd by = (e.values(j) - e.values(apart).array()).inverse().matrix();
    m.b_apart.row(j) = noise * left(j) * (V * by.asDiagonal() * b).colwise().norm();
    m.c_apart.row(j) = noise * right(j) * (c * by.asDiagonal() * W).rowwise().norm().transpose();
  }
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
  const double size = balanced.norm();
  sharpen_left(balanced, e);
  make_real(e, 100 * kEps * size);
  normalize(e);
  find_clusters(e, 100 * kEps * size, resolution, m);
  m.lambda = m.omega = e.values.cwiseAbs();
  const MatrixXd right_sizes = (e.scale.cwiseInverse().asDiagonal() * e.V).cwiseAbs(),
                 left_sizes = (e.W * e.scale.asDiagonal()).cwiseAbs().transpose();
  const Parts parts =
      find_parts(model.A, unit_columns(right_sizes).cwiseMax(unit_columns(left_sizes)), m);
  keep_to_parts(parts, e.V);
  keep_to_parts(parts, e.W.transpose());
  const VectorXd condition = conditions(e, m);
  turn_clusters(model, m, condition, e);
  m.b = (e.W * model.B).cwiseAbs();
  m.c = (model.C * e.V).transpose().cwiseAbs();
  for (Index j = 0; j < m.size(); ++j)
    m.states.push_back(e.values(j).imag() > 0 ? 2 : e.values(j).imag() < 0 ? 0 : 1);
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  find_mixing(e, left, right, size, m);
  set_apart(condition.cwiseMax(left.cwiseProduct(right)), size, m);
  find_apart(model, e, left, right, size, m);
  balance_sides(parts, m);
  find_needed(balanced, e.scale.cwiseInverse().asDiagonal() * model.B,
              model.C * e.scale.asDiagonal(), m);
  return g;
}

}  // namespace titop::modes
