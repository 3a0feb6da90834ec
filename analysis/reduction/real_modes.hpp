#pragma once

#include <Eigen/Core>
#include <vector>

/// Blocks of 2 x 2 from the eigenvectors of a matrix. For the library's own files only.
namespace titop::detail {

/// Real columns that span the eigenvectors of two states each: of a pair, or of two real ones; the
/// last column is that of a single real one, if there is one.
struct RealModes {
  Eigen::MatrixXd T;
  std::vector<Eigen::Matrix2d> A;
  std::vector<double> single;  ///< pole of the single one: none or one
};

/// Throws singular if eigenvectors are too close to each other, with `instead` as the way out.
/// O(n^3).
RealModes real_modes(const Eigen::MatrixXd& A, const char* instead);

}  // namespace titop::detail
