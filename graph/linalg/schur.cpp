#include <Eigen/Jacobi>
#include <cmath>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/converged.hpp>
#include <titop/graph/linalg/schur.hpp>

namespace titop::linalg {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using GivensRotation = Eigen::JacobiRotation<Complex>;

/// Rows and columns j, j + 1 turned, from column j on.
void turn(Schur& s, Index j, const GivensRotation& g) {
  s.T.rightCols(s.T.cols() - j).applyOnTheLeft(j, j + 1, g.adjoint());
  s.T.topRows(j + 2).applyOnTheRight(j, j + 1, g);
  s.Q.applyOnTheRight(j, j + 1, g);
  s.T(j + 1, j) = 0;
}

/// The 2 x 2 block at j becomes a triangle: its first new vector is an eigenvector.
void split_block(Schur& s, Index j) {
  const Complex a = s.T(j, j), b = s.T(j, j + 1), c = s.T(j + 1, j), d = s.T(j + 1, j + 1);
  const Complex half = (a - d) / 2.0, root = std::sqrt(half * half + b * c);
  const Complex lambda = (a + d) / 2.0 + root;
  GivensRotation g;
  g.makeGivens(lambda - d, c);
  turn(s, j, g);
  s.T(j, j) = lambda;
  s.T(j + 1, j + 1) = (a + d) / 2.0 - root;
}

/// Exchanges the eigenvalues at j and j + 1.
void exchange(Schur& s, Index j) {
  const Complex first = s.T(j, j), second = s.T(j + 1, j + 1);
  GivensRotation g;
  g.makeGivens(s.T(j, j + 1), second - first);
  turn(s, j, g);
  s.T(j, j) = second;
  s.T(j + 1, j + 1) = first;
}

}  // namespace

Schur schur(const MatrixXd& A) {
  if (A.rows() == 0) return {MatrixXcd(0, 0), MatrixXcd(0, 0)};
  if (!A.allFinite())
    throw Error(Code::not_finite, "the Schur form of a matrix with entries that are not finite",
                "look for overflow in the data");
  const auto [real, order] = converged<Eigen::RealSchur<MatrixXd>>(A, /*vectors=*/true);
  if (real.info() != Eigen::Success)
    throw Error(Code::singular, "the eigenvalue iteration did not converge",
                "look for entries that differ by more than 1e15");
  Schur s{real.matrixT().cast<Complex>(), MatrixXcd(A.rows(), A.cols())};
  s.Q(order, Eigen::all) = real.matrixU().cast<Complex>();
  for (Index j = A.rows() - 2; j >= 0; --j)
    if (s.T(j + 1, j) != 0.0) split_block(s, j);
  return s;
}

void reorder(Schur& s, std::vector<char> first) {
  std::size_t place = 0;
  for (std::size_t j = 0; j < first.size(); ++j) {
    if (!first[j]) continue;
    for (std::size_t k = j; k > place; --k) {
      exchange(s, static_cast<Index>(k) - 1);
      std::swap(first[k], first[k - 1]);
    }
    ++place;
  }
}

MatrixXcd sylvester(const MatrixXcd& A, const MatrixXcd& B, const MatrixXcd& C) {
  MatrixXcd X = C;
  if (X.size() == 0) return X;
  MatrixXcd shifted = A;
  for (Index j = 0; j < B.cols(); ++j) {
    X.col(j).noalias() += X.leftCols(j) * B.col(j).head(j);
    shifted.diagonal() = A.diagonal().array() - B(j, j);
    VectorXcd x = X.col(j);
    shifted.triangularView<Eigen::Upper>().solveInPlace(x);
    X.col(j) = x;
  }
  return X;
}

MatrixXcd lyapunov_factor(const MatrixXcd& T, const MatrixXcd& B) {
  const Index n = T.rows();
  MatrixXcd U = MatrixXcd::Zero(n, n), b = B, shifted = T;
  for (Index j = n - 1; j >= 0; --j) {
    const Eigen::RowVectorXcd last = b.row(j);
    const double norm = last.norm();
    if (norm == 0) continue;
    const double root = std::sqrt(-2 * T(j, j).real());
    U(j, j) = norm / root;
    if (j == 0) break;
    // (T_11 + conj(t_jj)) u = -t_1j U_jj - b_1 last^H / U_jj
    VectorXcd u = -T.col(j).head(j) * U(j, j) - b.topRows(j) * (last.adjoint() * (root / norm));
    shifted.diagonal().head(j) = T.diagonal().head(j).array() + std::conj(T(j, j));
    shifted.topLeftCorner(j, j).triangularView<Eigen::Upper>().solveInPlace(u);
    b.topRows(j) -= u * (last * (root / norm));
    U.col(j).head(j) = u;
  }
  return U;
}

}  // namespace titop::linalg
