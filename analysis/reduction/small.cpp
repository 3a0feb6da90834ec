#include <algorithm>
#include <cmath>
#include <titop/analysis/reduction/small.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <utility>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// (s^2 + s Z + k)^-1 f.
MatrixXcd solve(const Small& m, Complex s, const MatrixXcd& f) {
  MatrixXcd x = f;
  const Index own = m.Z.size() ? m.own : m.order(), rest = m.order() - own;
  for (Index j = 0; j < own; ++j) x.row(j) /= s * (s + (m.Z.size() ? m.Z(j, j) : 0.0)) + m.k(j);
  if (rest > 0) {
    MatrixXcd S = s * m.Z.bottomRightCorner(rest, rest).cast<Complex>();
    S.diagonal().array() += s * s + m.k.tail(rest).array();
    x.bottomRows(rest) = MatrixXcd(S.partialPivLu().solve(MatrixXcd(f.bottomRows(rest))));
  }
  return x;
}

/// The coupled coordinates in first order: positions, as far as they are states, then all rates.
struct FirstOrder {
  std::vector<Index> positions;  ///< among the coupled coordinates
  MatrixXd A;
};

FirstOrder first_order(const Small& m) {
  const Index rest = m.order() - m.own;
  FirstOrder f;
  for (Index j = 0; j < rest; ++j)
    if (m.has_position(m.own + j)) f.positions.push_back(j);
  const auto n = static_cast<Index>(f.positions.size());
  f.A = MatrixXd::Zero(n + rest, n + rest);
  for (Index i = 0; i < n; ++i) {
    const Index j = f.positions[static_cast<std::size_t>(i)];
    f.A(i, n + j) = 1;
    f.A(n + j, i) = -m.k(m.own + j);
  }
  f.A.bottomRightCorner(rest, rest) = -m.Z.bottomRightCorner(rest, rest);
  return f;
}

/// The coupled coordinates as a sum over poles.
void find_poles(Small& m) {
  const Index rest = m.Z.size() ? m.order() - m.own : 0;
  if (rest == 0) return;
  const FirstOrder f = first_order(m);
  const linalg::Eigensystem e = linalg::eigensystem(f.A);
  if (!(e.rcond_V > kDefective)) return;
  const MatrixXd ca = m.ca.rightCols(rest), b = m.b.bottomRows(rest),
                 read = m.cq.rightCols(rest) - ca * m.k.tail(rest).asDiagonal();
  MatrixXd C(ca.rows(), f.A.cols());
  C << read(Eigen::all, f.positions), m.cv.rightCols(rest) - ca * m.Z.bottomRightCorner(rest, rest);
  m.pole = e.values;
  m.left = C.cast<Complex>() * e.V;
  m.right = e.W.rightCols(rest) * b.cast<Complex>();
  m.instant = ca * b;
}

}  // namespace

int Small::states() const {
  Index count = order();
  for (Index j = 0; j < order(); ++j) count += has_position(j);
  return static_cast<int>(count);
}

MatrixXcd Small::transfer(Complex s) const {
  if (order() == 0) return D0.cast<Complex>();
  if (Z.size() == 0 || own == order() || pole.size() == 0) {
    const MatrixXcd c = s * s * ca.cast<Complex>() + s * cv.cast<Complex>() + cq.cast<Complex>();
    return D0.cast<Complex>() + c * solve(*this, s, b.cast<Complex>());
  }
  MatrixXcd H = (D0 + instant).cast<Complex>();
  H += left * (s - pole.array()).inverse().matrix().asDiagonal() * right;
  for (Index j = 0; j < own; ++j) {
    const Eigen::VectorXcd c = s * (s * ca.col(j) + cv.col(j)) + cq.col(j);
    H += c * (b.row(j) / (s * (s + Z(j, j)) + k(j)));
  }
  return H;
}

Eigen::VectorXcd Small::response(Complex s, Index m) const {
  return solve(*this, s, b.col(m).cast<Complex>());
}

std::vector<Complex> Small::poles() const {
  std::vector<Complex> result;
  const Index free = Z.size() ? own : order(), rest = order() - free;
  for (Index j = 0; j < free; ++j) {
    const double half = Z.size() ? Z(j, j) / 2 : 0;
    const Complex root = std::sqrt(Complex(half * half - k(j), 0));
    result.push_back(-half + root);
    if (root.imag() == 0) result.push_back(-half - root);
  }
  if (rest == 0) return result;
  const FirstOrder f = first_order(*this);
  const auto at_zero = std::count_if(f.positions.begin(), f.positions.end(),
                                     [&](Index j) { return k(own + j) == 0; });
  for (const Complex& p : upper_poles(f.A, resting + at_zero)) result.push_back(p);
  return result;
}

SymmetricModes ritz(const VectorXd& lambda, const MatrixXd& W) {
  const Index r = W.cols();
  const MatrixXd K = W.transpose() * lambda.asDiagonal() * W;
  SymmetricModes inverse = eigh(solve_definite(K, MatrixXd(MatrixXd::Identity(r, r))));
  return {inverse.lambda.reverse().cwiseInverse(), inverse.V.rowwise().reverse()};
}

Small project(const Whole& w, const std::vector<Index>& of_band, const MatrixXd& W) {
  std::vector<Index> kept = of_band;
  std::sort(kept.begin(), kept.end(), [&](Index i, Index j) {
    return std::pair(w.lambda(i), i) < std::pair(w.lambda(j), j);
  });
  Small m;
  const Index n = w.elastic(), own = w.loose + static_cast<Index>(kept.size());
  m.V = MatrixXd::Zero(w.order(), own + W.cols());
  m.k = VectorXd::Zero(m.V.cols());
  for (Index j = 0; j < w.loose; ++j) m.V(n + j, j) = 1;
  for (std::size_t j = 0; j < kept.size(); ++j) {
    m.V(kept[j], w.loose + static_cast<Index>(j)) = 1;
    m.k(w.loose + static_cast<Index>(j)) = w.lambda(kept[j]);
  }
  if (W.cols() > 0) {
    const SymmetricModes modes = ritz(w.lambda.head(n), W);
    m.V.block(0, own, n, W.cols()) = W * modes.V;
    m.k.tail(W.cols()) = modes.lambda;
  }
  m.own = w.proportional ? own : w.loose_coupled ? 0 : w.loose;
  m.resting = w.resting;
  if (w.Z.size() > 0)
    m.Z = w.proportional ? MatrixXd(m.V.transpose() * w.Z.diagonal().asDiagonal() * m.V)
                         : MatrixXd(m.V.transpose() * w.Z * m.V);
  m.b = m.V.transpose() * w.b;
  m.ca = w.ca * m.V;
  m.cv = w.cv * m.V;
  m.cq = w.cq * m.V;
  m.D0 = w.D0;
  // A position is projected as a position, so that collocated inputs and outputs remain collocated;
  // then it is written with accelerations again.
  for (Index i = 0; i < m.ca.rows(); ++i) {
    if (!w.is_position[static_cast<std::size_t>(i)]) continue;
    const Eigen::RowVectorXd read =
        -(w.ca.row(i).head(n).cwiseProduct(w.lambda.head(n).transpose())) * m.V.topRows(n);
    const Eigen::RowVectorXd rate =
        w.Z.size() ? Eigen::RowVectorXd((w.cv.row(i) - w.ca.row(i) * w.Z) * m.V) : m.cv.row(i);
    for (Index j = w.loose; j < m.order(); ++j) m.ca(i, j) = -read(j) / m.k(j);
    m.cv.row(i) = rate;
    if (m.Z.size() > 0) m.cv.row(i) += m.ca.row(i) * m.Z;
  }
  find_poles(m);
  return m;
}

}  // namespace titop::detail
