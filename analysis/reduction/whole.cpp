#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <titop/analysis/reduction/whole.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kCoupled = 1e-10;  ///< entry of Z between two modes, on their own scales
constexpr double kSeen = 1e-12;     ///< of a port's sensitivity to all modes: less is rounding
constexpr double kLeak = 3e-9;  ///< the same with closed chains, which have dependent coordinates

using linalg::at;

/// Modes in coordinates scaled to stiffness 1: P y = mu K y with P = M scaled, largest mu first, so
/// that the low modes keep their digits.
struct ScaledModes {
  VectorXd lambda;  ///< ascending, without those that rounding hides
  MatrixXd y;       ///< y'Ky = 1, one mode per column
  MatrixXd K;       ///< scaled
  VectorXd d;       ///< sqrt of the diagonal of K
};

/// Columns mu, y of P y = mu K y, ascending. The softest coordinates, where P is largest, come
/// first: in this order the eigensolver keeps the digits of small entries [Wilkinson, Reinsch 1971,
/// Handbook, II/2], and a soft spring does not affect a stiff structure next to it.
SymmetricModes soft_first(const MatrixXd& P, const MatrixXd& K) {
  std::vector<Index> order(at(P.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return P(i, i) > P(j, j); });
  const MatrixXd sorted = P(order, order);
  const SymmetricModes m = K.size() == 0 ? eigh(sorted) : eigh(sorted, K(order, order));
  SymmetricModes result{m.lambda, MatrixXd(m.V.rows(), m.V.cols())};
  result.V(order, Eigen::all) = m.V;
  return result;
}

ScaledModes modes(const Coordinates& c) {
  ScaledModes s;
  const Index n = c.n_elastic;
  s.d = c.K.diagonal().cwiseSqrt();
  const VectorXd inverse = s.d.cwiseInverse();
  const MatrixXd P =
      solve_definite(s.d.asDiagonal() * c.G * s.d.asDiagonal(), MatrixXd(MatrixXd::Identity(n, n)));
  if (!c.diagonal) s.K = inverse.asDiagonal() * c.K * inverse.asDiagonal();
  const SymmetricModes m = soft_first(P, s.K);
  // The error of entries of P is eps of their row's and column's diagonal: likewise of mu.
  const VectorXd noise = static_cast<double>(n) * std::numeric_limits<double>::epsilon() *
                         m.V.cwiseAbs2().transpose() * P.diagonal();
  Index count = 0;
  while (count < n && m.lambda(n - 1 - count) > noise(n - 1 - count)) ++count;
  if (count == 0)
    throw Error(Code::not_finite, fmt::format("no mode of {} is finite", c.names.front()),
                "look for stiffnesses and masses that are far too large or too small");
  s.lambda = m.lambda.tail(count).reverse().cwiseInverse();
  s.y = m.V.rightCols(count).rowwise().reverse();
  return s;
}

/// Turns modes of equal frequency among themselves so that each looks different from the ports.
void turn_clusters(VectorXd& lambda, MatrixXd& phi, const MatrixXd& b, const MatrixXd& c) {
  // Sensitivity of each port to all modes: the scale of its rounding.
  Eigen::RowVectorXd all(b.cols() + c.rows());
  all << b.colwise().norm(), c.rowwise().norm().transpose();
  for (Index first = 0, last = 0; first < lambda.size(); first = last) {
    last = first + 1;
    while (last < lambda.size() &&
           lambda(last) - lambda(last - 1) <= 2 * linalg::kSameFrequency * lambda(last))
      ++last;
    if (last - first < 2) continue;
    MatrixXd seen(last - first, b.cols() + c.rows());
    seen << b.middleRows(first, last - first), c.middleCols(first, last - first).transpose();
    for (Index j = 0; j < seen.cols(); ++j) {
      // A port whose share of the cluster is rounding has no influence on its rotation.
      const double size = seen.col(j).norm();
      seen.col(j) *= size > kSeen * all(j) ? 1 / size : 0;
    }
    const Eigen::JacobiSVD<MatrixXd> svd(seen, Eigen::ComputeFullU);
    phi.middleCols(first, last - first) *= svd.matrixU();
    lambda.segment(first, last - first).setConstant(lambda.segment(first, last - first).mean());
  }
}

/// The transfer at one real s minus that of the modes. s is above the poles of a damped structure,
/// and small enough compared with the band that far modes do not matter.
MatrixXd rest(const System& system, const Whole& w) {
  double s = 1;
  if (w.elastic() > 0) s = std::sqrt(w.lambda(0));
  MatrixXd H = system.transfer(s).real();
  if (w.order() == 0) return H;
  MatrixXd x = w.b;
  const VectorXd stiff = (w.lambda.array() + s * s).matrix();
  if (w.Z.size() == 0) {
    x.array().colwise() /= stiff.array();
  } else if (w.proportional) {
    x.array().colwise() /= stiff.array() + s * w.Z.diagonal().array();
  } else {
    x = solve_definite(s * w.Z + MatrixXd(stiff.asDiagonal()), w.b);
  }
  return H - (s * s * w.ca + s * w.cv + w.cq) * x;
}

bool is_diagonal(const MatrixXd& Z) {
  for (Index i = 0; i < Z.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (std::abs(Z(i, j)) > kCoupled * std::sqrt(Z(i, i)) * std::sqrt(Z(j, j))) return false;
  return true;
}

/// Block of every coordinate without stiffness, -1 if none has its name.
std::vector<Index> owners(const Coordinates& c) {
  std::vector<Index> result(at(c.size() - c.n_elastic), -1);
  for (Index j = c.n_elastic; j < c.size(); ++j)
    for (std::size_t i = 0; i < c.blocks.size(); ++i)
      if (c.names[at(j)].starts_with(c.blocks[i] + "."))
        result[at(j - c.n_elastic)] = static_cast<Index>(i);
  return result;
}

/// Input vectors of the loose motions, driven through the elastic ones.
MatrixXd carried(const Coordinates& c, const Whole& w, const MatrixXd& along) {
  if (w.far == 0) return along * w.b;
  // Modes below rounding move them, too: their static part, K^-1 M b of all.
  return -c.A_loose * solve_definite(c.K, solve_definite(c.G, c.B.topRows(c.n_elastic)));
}

/// Outputs from the modes `phi` of all coordinates.
void read_outputs(Whole& w, const Coordinates& c, const MatrixXd& phi) {
  const Index m = w.elastic();
  w.cq = c.C_q * phi;
  w.cv = c.C_v * phi;
  w.ca = MatrixXd::Zero(w.cq.rows(), w.cq.cols());
  w.ca.leftCols(m) = -w.cq.leftCols(m) * w.lambda.head(m).cwiseInverse().asDiagonal();
  w.cq.leftCols(m).setZero();
  if (w.Z.size() > 0) w.cv += w.ca * w.Z;
}

void drop(Eigen::Ref<MatrixXd> m) {
  const double least = m.size() ? kLeak * m.cwiseAbs().maxCoeff() : 0;
  m = (m.array().abs() > least).select(m, 0);
}

/// Removes the ports' sensitivity to modes at rounding level: pairs that are zero by symmetry
/// remain so.
void drop_leaks(Whole& w) {
  const Index n = w.elastic();
  for (Index j = 0; j < w.b.cols(); ++j) drop(w.b.block(0, j, n, 1));
  for (MatrixXd* c : {&w.ca, &w.cv})
    for (Index i = 0; i < c->rows(); ++i) drop(c->block(i, 0, 1, n));
}

/// Modes of the coordinates with stiffness, mass-normalised; returns their input vectors.
MatrixXd elastic_modes(Whole& w, const Coordinates& c) {
  const Index n = c.n_elastic;
  ScaledModes s = modes(c);
  const MatrixXd Kd = c.diagonal ? MatrixXd(s.d.asDiagonal()) : MatrixXd(s.K * s.d.asDiagonal());
  const MatrixXd forces = Kd * c.B.topRows(n),
                 read = c.C_q.leftCols(n) * s.d.cwiseInverse().asDiagonal();
  turn_clusters(s.lambda, s.y, s.y.transpose() * forces, read * s.y);
  const VectorXd omega = s.lambda.cwiseSqrt();
  w.far = n - s.lambda.size();
  w.lambda = s.lambda;
  w.b = omega.cwiseInverse().asDiagonal() * (s.y.transpose() * forces);
  w.shapes = s.y * omega.asDiagonal();
  if (!c.diagonal) w.pulls = s.K * w.shapes;
  return s.d.cwiseInverse().asDiagonal() * w.shapes;
}

}  // namespace

Whole whole(const System& system, const Coordinates& c, std::vector<char> is_position) {
  Whole w;
  const Index n = c.n_elastic, loose = c.size() - n;
  w.is_position = std::move(is_position);
  w.silent = c.silent;
  w.loose = loose;
  w.blocks = c.blocks;
  w.shares = c.shares;
  w.owner = owners(c);
  w.b.resize(0, c.B.cols());
  MatrixXd elastic(n, 0);
  if (n > 0) elastic = elastic_modes(w, c);
  const Index m = w.lambda.size();
  MatrixXd phi = MatrixXd::Zero(c.size(), m + loose);
  phi.topLeftCorner(n, m) = elastic;
  phi.bottomRightCorner(loose, loose).setIdentity();
  phi.bottomLeftCorner(loose, m) = -c.A_loose * (elastic * w.lambda.cwiseInverse().asDiagonal());
  const MatrixXd b_loose = c.B.bottomRows(loose) - carried(c, w, phi.bottomLeftCorner(loose, m));
  w.lambda.conservativeResize(m + loose);
  w.lambda.tail(loose).setZero();
  w.b.conservativeResize(m + loose, Eigen::NoChange);
  w.b.bottomRows(loose) = b_loose;
  if (c.D.size() > 0) {
    w.Z = MatrixXd::Zero(m + loose, m + loose);
    w.Z.topLeftCorner(m, m) = elastic.transpose() * c.D * elastic;
    w.proportional = is_diagonal(w.Z);
    if (w.proportional) w.Z = MatrixXd(w.Z.diagonal().asDiagonal());
  }
  read_outputs(w, c, phi);
  if (!c.diagonal) drop_leaks(w);
  w.D0 = rest(system, w);
  return w;
}

void couple(Whole& w) {
  if (w.proportional) return;
  const Index m = w.elastic(), n = w.loose_coupled ? w.order() : m;
  const VectorXd omega = w.lambda.head(m).cwiseSqrt();
  MatrixXd A = MatrixXd::Zero(m + n, m + n);  // positions times omega: entries of one size
  A.topRightCorner(m, n).leftCols(m) = omega.asDiagonal();
  A.bottomLeftCorner(n, m).topRows(m) = (-omega).asDiagonal();
  A.bottomRightCorner(n, n) = -w.Z.topLeftCorner(n, n);
  w.poles = upper_poles(A, w.resting);
}

std::vector<std::complex<double>> upper_poles(const MatrixXd& A, Index zeros) {
  Eigen::VectorXcd all = linalg::eigenvalues(A);
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& p, const auto& q) { return std::abs(p) < std::abs(q); });
  all.head(zeros).setZero();
  std::vector<std::complex<double>> result;
  for (const std::complex<double>& p : all)
    if (p.imag() >= 0) result.push_back(p);
  return result;
}

MatrixXd participation(const Whole& w, const MatrixXd& V) {
  const MatrixXd elastic = V.topRows(w.elastic()), z = w.shapes * elastic;
  const MatrixXd pulls = w.pulls.size() ? MatrixXd(w.pulls * elastic) : z;
  MatrixXd result = w.shares * z.cwiseProduct(pulls).cwiseAbs();
  for (Index j = 0; j < V.cols(); ++j) {
    if (const double sum = result.col(j).sum(); sum > 0) {
      result.col(j) /= sum;
    } else if (Index own = 0; w.loose > 0 && !w.owner.empty()) {
      V.col(j).tail(w.loose).cwiseAbs().maxCoeff(&own);
      if (w.owner[at(own)] >= 0) result(w.owner[at(own)], j) = 1;
    }
  }
  return result;
}

std::vector<char> positions_read(const Graph& g) {
  std::vector<const Output*> declared;
  for (const Output& o : g.outputs) declared.push_back(&o);
  std::sort(declared.begin(), declared.end(),
            [](const Output* a, const Output* b) { return a->declared < b->declared; });
  const auto signal = [&](const Term& t) -> const Signal& { return g.signals[at(t.signal)]; };
  const auto is = [&](const Term& t, Term::Of of, Quantity quantity) {
    return t.of == of || (t.of == Term::Of::signal && signal(t).quantity == quantity);
  };
  const auto position = [&](const Term& t) {
    return is(t, Term::Of::position, Quantity::position);
  };
  const auto beside = [&](const Term& t) {
    return is(t, Term::Of::rate, Quantity::velocity) ||
           (t.of == Term::Of::signal && signal(t).role == Signal::Role::external);
  };
  std::vector<char> result;
  for (const Output* o : declared)
    result.insert(result.end(), at(o->size),
                  std::any_of(o->terms.begin(), o->terms.end(), position) &&
                      std::all_of(o->terms.begin(), o->terms.end(),
                                  [&](const Term& t) { return position(t) || beside(t); }));
  return result;
}

}  // namespace titop::detail
