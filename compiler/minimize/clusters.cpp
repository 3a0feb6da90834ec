#include <titop/compiler/minimize/clusters.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::modes {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

template <class Matrix>
Matrix turned(const Matrix& b, const Matrix& c) {
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

}  // namespace

MatrixXd turn(const MatrixXd& b, const MatrixXd& c) { return turned(b, c); }
MatrixXcd turn(const MatrixXcd& b, const MatrixXcd& c) { return turned(b, c); }

bool clearly_full_rank(MatrixXd M) {
  if (M.rows() == 0) return true;
  const Eigen::VectorXd size = M.rowwise().norm();
  if (M.cols() < M.rows() || !(size.minCoeff() > kClearRow * size.maxCoeff())) return false;
  M = size.cwiseInverse().asDiagonal() * M;
  return Eigen::BDCSVD<MatrixXd>(M).singularValues()(M.rows() - 1) > kClearRank;
}

}  // namespace titop::modes
