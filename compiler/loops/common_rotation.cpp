#include <Eigen/Geometry>
#include <titop/compiler/loops/common_rotation.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {
namespace {

using Eigen::MatrixXd;

bool is_rotation(const Matrix3d& Q) {
  return Q.determinant() > 0 &&
         (Q.transpose() * Q - Matrix3d::Identity()).norm() <= linalg::kMatrixDigits;
}

/// Nearest to M = sum of s' c over the rows (Kabsch): M has one singular value for every direction
/// that is tied, 1 or 2.
Matrix3d nearest(const Matrix3d& M) {
  constexpr double kTied = 0.5;
  const Eigen::JacobiSVD<MatrixXd> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (!(svd.singularValues()(1) > kTied))
    return Eigen::Quaterniond::FromTwoVectors(V.col(0), U.col(0)).toRotationMatrix();
  const double turn = (U * V.transpose()).determinant();
  return U * Vector3d(1, 1, turn).asDiagonal() * V.transpose();
}

}  // namespace

std::optional<Matrix3d> common_rotation(const MatrixXd& S, const MatrixXd& c) {
  const Matrix3d linear = S.leftCols(3).transpose() * c.leftCols(3);
  const Matrix3d angular = S.rightCols(3).transpose() * c.rightCols(3);
  const Matrix3d Q = is_rotation(linear)    ? linear
                     : is_rotation(angular) ? angular
                                            : nearest(linear + angular);
  MatrixXd turned(S.rows(), 6);
  turned << S.leftCols(3) * Q, S.rightCols(3) * Q;
  if ((turned - c).cwiseAbs().maxCoeff() <= linalg::kMatrixDigits) return Q;
  return std::nullopt;
}

}  // namespace titop::loops
