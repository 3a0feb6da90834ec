#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <titop/compiler/economy/whole.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEqual = 1e-9;  ///< relative gap of frequencies that count as one

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Modes in coordinates scaled to stiffness 1: P y = mu K y with P = M scaled, largest mu first, so
/// that the low modes keep their digits (design.md, economy: the inverse problem).
struct Scaled {
  VectorXd lambda;  ///< ascending
  MatrixXd y;       ///< y'Ky = 1, one mode per column
  MatrixXd K;       ///< scaled
  VectorXd d;       ///< sqrt of the diagonal of K
};

Scaled modes(const Coordinates& c) {
  Scaled s;
  const Index n = c.n_elastic;
  s.d = c.K.diagonal().cwiseSqrt();
  const VectorXd inverse = s.d.cwiseInverse();
  const MatrixXd P =
      solve_definite(s.d.asDiagonal() * c.G * s.d.asDiagonal(), MatrixXd(MatrixXd::Identity(n, n)));
  SymmetricModes m;
  if (c.diagonal) {
    m = eigh(P);
  } else {
    s.K = inverse.asDiagonal() * c.K * inverse.asDiagonal();
    m = eigh(P, s.K);
  }
  s.lambda = m.lambda.reverse().cwiseInverse();
  s.y = m.V.rowwise().reverse();
  return s;
}

/// Turns modes of equal frequency among themselves so that each looks different from the ports.
void turn_clusters(VectorXd& lambda, MatrixXd& phi, const MatrixXd& b, const MatrixXd& c) {
  for (Index first = 0, last = 0; first < lambda.size(); first = last) {
    last = first + 1;
    while (last < lambda.size() && lambda(last) - lambda(last - 1) <= 2 * kEqual * lambda(last))
      ++last;
    if (last - first < 2) continue;
    MatrixXd seen(last - first, b.cols() + c.rows());
    seen << b.middleRows(first, last - first), c.middleCols(first, last - first).transpose();
    for (Index j = 0; j < seen.cols(); ++j)
      if (const double size = seen.col(j).norm(); size > 0) seen.col(j) /= size;
    const Eigen::JacobiSVD<MatrixXd> svd(seen, Eigen::ComputeFullU);
    phi.middleCols(first, last - first) *= svd.matrixU();
    lambda.segment(first, last - first).setConstant(lambda.segment(first, last - first).mean());
  }
}

/// Elastic energy by blocks; loose motions belong to their own block.
MatrixXd shares(const Coordinates& c, const Scaled& s) {
  const Index n = c.n_elastic;
  MatrixXd result = MatrixXd::Zero(static_cast<Index>(c.blocks.size()), c.size());
  if (n > 0) {
    const MatrixXd Ky = c.diagonal ? s.y : MatrixXd(s.K * s.y);
    result.leftCols(n) = c.shares * s.y.cwiseProduct(Ky).cwiseAbs();
  }
  for (Index j = 0; j < n; ++j) result.col(j) /= result.col(j).sum();
  for (Index j = n; j < c.size(); ++j)
    for (Index i = 0; i < result.rows(); ++i)
      if (c.names[at(j)].starts_with(c.blocks[at(i)] + ".")) result(i, j) = 1;
  return result;
}

/// What the transfer at one real s has beside the modes. Above the poles of a damped structure, and
/// small enough beside the band that far modes do not matter.
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
      if (std::abs(Z(i, j)) > 1e-10 * std::sqrt(Z(i, i)) * std::sqrt(Z(j, j))) return false;
  return true;
}

}  // namespace

Whole whole(const System& system, const Coordinates& c, std::vector<char> is_position) {
  Whole w;
  const Index n = c.n_elastic;
  w.is_position = std::move(is_position);
  w.is_silent = c.is_silent;
  w.loose = c.size() - n;
  w.lambda = VectorXd::Zero(c.size());
  MatrixXd phi = MatrixXd::Zero(c.size(), c.size());
  phi.bottomRightCorner(w.loose, w.loose).setIdentity();
  w.b = c.B;
  if (n > 0) {
    Scaled s = modes(c);
    const MatrixXd Kd = c.diagonal ? MatrixXd(s.d.asDiagonal()) : MatrixXd(s.K * s.d.asDiagonal());
    const MatrixXd forces = Kd * c.B.topRows(n),
                   read = c.C_q.leftCols(n) * s.d.cwiseInverse().asDiagonal();
    turn_clusters(s.lambda, s.y, s.y.transpose() * forces, read * s.y);
    const VectorXd omega = s.lambda.cwiseSqrt();
    w.lambda.head(n) = s.lambda;
    phi.topLeftCorner(n, n) = s.d.cwiseInverse().asDiagonal() * s.y * omega.asDiagonal();
    phi.bottomLeftCorner(w.loose, n) =
        -c.A_loose * phi.topLeftCorner(n, n) * s.lambda.cwiseInverse().asDiagonal();
    w.b.topRows(n) = omega.cwiseInverse().asDiagonal() * (s.y.transpose() * forces);
    w.b.bottomRows(w.loose) -= phi.bottomLeftCorner(w.loose, n) * w.b.topRows(n);
    if (c.D.size() > 0) {
      w.Z = MatrixXd::Zero(c.size(), c.size());
      w.Z.topLeftCorner(n, n) = phi.topLeftCorner(n, n).transpose() * c.D * phi.topLeftCorner(n, n);
      w.proportional = is_diagonal(w.Z);
      if (w.proportional) w.Z = MatrixXd(w.Z.diagonal().asDiagonal());
    }
    w.shares = shares(c, s);
  } else {
    w.shares = shares(c, {});
  }
  w.blocks = c.blocks;
  const MatrixXd cq = c.C_q * phi;
  w.cv = c.C_v * phi;
  w.ca = MatrixXd::Zero(cq.rows(), cq.cols());
  w.ca.leftCols(n) = -cq.leftCols(n) * w.lambda.head(n).cwiseInverse().asDiagonal();
  w.cq = cq;
  w.cq.leftCols(n).setZero();
  if (w.Z.size() > 0) w.cv += w.ca * w.Z;
  w.D0 = rest(system, w);
  for (Index i = 0; i < w.D0.rows(); ++i)
    if (w.is_silent[at(i)]) w.D0.row(i).setZero();
  return w;
}

std::vector<char> positions_read(const Graph& g) {
  std::vector<const Output*> declared;
  for (const Output& o : g.outputs) declared.push_back(&o);
  std::sort(declared.begin(), declared.end(),
            [](const Output* a, const Output* b) { return a->declared < b->declared; });
  std::vector<char> result;
  for (const Output* o : declared) {
    const bool position = std::all_of(o->terms.begin(), o->terms.end(), [&](const Term& t) {
      return t.of == Term::Of::position ||
             (t.of == Term::Of::signal && g.signals[at(t.signal)].quantity == Quantity::position);
    });
    result.insert(result.end(), at(o->size), position && !o->terms.empty());
  }
  return result;
}

}  // namespace titop::detail
