#pragma once

#include <Eigen/SVD>
#include <limits>
#include <titop/compiler/minimize/modes.hpp>

/// What both kinds of modes need: modes of one frequency, and ranks. For the compiler's own files.
namespace titop::modes {

inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr double kSameFrequency = 1e-9;  ///< relative: as close as this, modes are equal
inline constexpr double kNoPart = 1e-8;     ///< of a cluster's largest: what is below takes no part
inline constexpr double kClearRank = 1e-6;  ///< least singular value that rounding cannot have made
inline constexpr double kClearRow = 1e-10;  ///< likewise of a whole row
inline const char* const kAtZero = "its pole is at 0";

template <class Matrix>
Matrix unit_columns(Matrix m) {
  for (Eigen::Index l = 0; l < m.cols(); ++l)
    if (const double n = m.col(l).norm(); n > 0) m.col(l) /= n;
  return m;
}

/// Turns k modes of one frequency among themselves: first those that no input moves go to the end,
/// then, among the others, those that no output sees. b: k x inputs, c: k x outputs, each column of
/// weight one. Returns the k x k unitary matrix whose columns are the new modes.
template <class Matrix>
Matrix turn(const Matrix& b, const Matrix& c) {
  const Eigen::Index k = b.rows();
  Matrix result = Matrix::Identity(k, k);
  Eigen::Index reached = k;
  if (b.cols() > 0) {
    const Eigen::JacobiSVD<Matrix> svd(b, Eigen::ComputeFullU);
    result = svd.matrixU();
    const Eigen::VectorXd sigma = svd.singularValues();
    reached = 0;
    while (reached < sigma.size() && sigma(reached) > kNoPart * sigma(0)) ++reached;
  }
  if (c.cols() > 0 && reached > 1) {
    const Matrix seen = result.leftCols(reached).adjoint() * c;
    const Eigen::JacobiSVD<Matrix> svd(seen, Eigen::ComputeFullU);
    result.leftCols(reached) = (result.leftCols(reached) * svd.matrixU()).eval();
  }
  return result;
}

/// True if no combination of the rows of M vanishes but for rounding. A row far below the others
/// may be nothing but rounding itself.
inline bool clearly_full_rank(Eigen::MatrixXd M) {
  if (M.rows() == 0) return true;
  const Eigen::VectorXd size = M.rowwise().norm();
  if (M.cols() < M.rows() || !(size.minCoeff() > kClearRow * size.maxCoeff())) return false;
  M = size.cwiseInverse().asDiagonal() * M;
  return Eigen::BDCSVD<Eigen::MatrixXd>(M).singularValues()(M.rows() - 1) > kClearRank;
}

}  // namespace titop::modes
