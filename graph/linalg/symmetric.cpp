#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/svd.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void require_square(const MatrixXd& S, const char* name) {
  if (S.rows() != S.cols())
    throw Error(Code::size, fmt::format("{} is {} x {}, not square", name, S.rows(), S.cols()),
                "give as many rows as columns");
  for (Index j = 0; j < S.cols(); ++j)
    for (Index i = j; i < S.rows(); ++i)
      if (!std::isfinite(S(i, j)))
        throw Error(Code::not_finite, fmt::format("{}({}, {}) is {}", name, i, j, S(i, j)),
                    "give finite numbers");
}

void require_pair(const MatrixXd& K, const MatrixXd& M) {
  require_square(K, "K");
  require_square(M, "M");
  if (K.rows() != M.rows())
    throw Error(Code::size, fmt::format("K is {0} x {0}, M is {1} x {1}", K.rows(), M.rows()),
                "give both the same size");
}

Eigen::LLT<MatrixXd> cholesky(const MatrixXd& S, const char* name) {
  Eigen::LLT<MatrixXd> llt(S);
  if (S.rows() > 0 && llt.info() != Eigen::Success)
    throw Error(Code::singular,
                fmt::format("{} is not positive definite at row {}", name, weak_pivot(S)),
                "clamp the free degree of freedom there, or give it stiffness or mass");
  return llt;
}

/// Largest entry positive. An entry counts as largest within 1e-6, so that in (anti)symmetric
/// vectors it is the first one, independent of rounding.
MatrixXd with_signs(MatrixXd V) {
  for (Index j = 0; j < V.cols(); ++j) {
    const double largest = V.col(j).cwiseAbs().maxCoeff();
    Index i = 0;
    while (std::abs(V(i, j)) < linalg::kEqual * largest) ++i;
    if (V(i, j) < 0) V.col(j) *= -1;
  }
  return V;
}

SymmetricModes solve(const MatrixXd& S) {
  if (S.rows() == 0) return {VectorXd(0), MatrixXd(0, 0)};
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver(S);
  if (solver.info() != Eigen::Success)
    throw Error(Code::singular, "the symmetric eigenvalue iteration did not converge",
                "look for entries of extreme size");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

/// L^-1 S L^-T, S by its lower triangle.
MatrixXd congruence(const Eigen::LLT<MatrixXd>& llt, const MatrixXd& S) {
  MatrixXd A = S.selfadjointView<Eigen::Lower>();
  llt.matrixL().solveInPlace(A);
  llt.matrixU().solveInPlace<Eigen::OnTheRight>(A);
  return A;
}

}  // namespace

SymmetricModes eigh(const MatrixXd& S) {
  require_square(S, "S");
  SymmetricModes modes = solve(S);
  modes.V = with_signs(std::move(modes.V));
  return modes;
}

SymmetricModes eigh(const MatrixXd& K, const MatrixXd& M) {
  require_pair(K, M);
  const auto llt = cholesky(M, "M");
  SymmetricModes modes = solve(congruence(llt, K));
  llt.matrixU().solveInPlace(modes.V);
  modes.V = with_signs(std::move(modes.V));
  return modes;
}

SymmetricModes eigh_definite(const MatrixXd& K, const MatrixXd& M) {
  require_pair(K, M);
  if (K.rows() == 0) return {VectorXd(0), MatrixXd(0, 0)};
  const auto llt_K = cholesky(K, "K");
  const auto llt_M = cholesky(M, "M");
  MatrixXd W = llt_K.matrixU();
  llt_M.matrixU().solveInPlace<Eigen::OnTheRight>(W);
  const linalg::Svd svd = linalg::svd(W);
  MatrixXd V = svd.V.rowwise().reverse();
  llt_M.matrixU().solveInPlace(V);
  return {svd.sigma.reverse().array().square(), with_signs(std::move(V))};
}

SymmetricModes eigh_lowest(const MatrixXd& K, const MatrixXd& M, Index count) {
  require_pair(K, M);
  const Index n = K.rows();
  const auto llt_K = cholesky(K, "K");
  const SymmetricModes inverse = solve(congruence(llt_K, M));
  const double noise =
      n == 0 ? 0.0 : double(n) * std::numeric_limits<double>::epsilon() * inverse.lambda(n - 1);
  const Index finite = (inverse.lambda.array() > noise).count();
  if (count < 0 || count > finite)
    throw Error(Code::bad_value,
                fmt::format("{} modes asked, {} of {} can be told from infinite "
                            "ones",
                            count, finite, n),
                "ask for fewer modes");
  const VectorXd mu = inverse.lambda.tail(count).reverse();
  MatrixXd V = inverse.V.rightCols(count).rowwise().reverse();
  llt_K.matrixU().solveInPlace(V);
  V *= mu.cwiseSqrt().cwiseInverse().asDiagonal();
  // The factor is upper triangular: each mode is corrected by those below it, the lowest by none.
  const MatrixXd G = V.transpose() * (M.selfadjointView<Eigen::Lower>() * V);
  cholesky(G, "V'MV").matrixU().solveInPlace<Eigen::OnTheRight>(V);
  return {mu.cwiseInverse(), with_signs(std::move(V))};
}

Index weak_pivot(const MatrixXd& S, double tolerance) {
  require_square(S, "S");
  const Index n = S.rows();
  MatrixXd L = MatrixXd::Zero(n, n);
  for (Index j = 0; j < n; ++j) {
    const Index below = n - j;
    VectorXd column = S.col(j).tail(below);
    column.noalias() -= L.block(j, 0, below, j) * L.row(j).head(j).transpose();
    if (!(column(0) > tolerance * std::abs(S(j, j)))) return j;
    L.col(j).tail(below) = column / std::sqrt(column(0));
  }
  return -1;
}

MatrixXd solve_definite(const MatrixXd& K, const MatrixXd& B) {
  require_square(K, "K");
  if (K.rows() != B.rows())
    throw Error(Code::size, fmt::format("K has {} rows, B has {}", K.rows(), B.rows()),
                "give both the same number of rows");
  if (K.rows() == 0) return B;
  return cholesky(K, "K").solve(B);
}

}  // namespace titop
