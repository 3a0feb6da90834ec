#pragma once

#include <Eigen/Core>
#include <cmath>

#include "support/rng.hpp"

/// The kinds of input on which algorithms of linear algebra are tried.
namespace titop_test {

enum class Input { dense, scaled, permuted, singular };
constexpr Input kInputs[] = {Input::dense, Input::scaled, Input::permuted, Input::singular};

/// Rows and columns times powers of two, 2^-30 to 2^30.
inline Eigen::MatrixXd scaled(Rng& rng, Eigen::MatrixXd A) {
  for (Eigen::Index i = 0; i < A.rows(); ++i) A.row(i) *= std::ldexp(1, rng.below(61) - 30);
  for (Eigen::Index i = 0; i < A.cols(); ++i) A.col(i) *= std::ldexp(1, rng.below(61) - 30);
  return A;
}

/// n x n, entries in [-1, 1]; permuted: with the largest of each row and column off the diagonal;
/// singular: integers of up to 7 bits, the last row depends on the others (0 up to n = 2).
inline Eigen::MatrixXd random_matrix(Rng& rng, Input input, Eigen::Index n) {
  Eigen::MatrixXd A = rng.matrix(n, n);
  if (input == Input::permuted) {
    A /= 1024;
    for (Eigen::Index i = 0; i < n; ++i)
      A((i + (n + 1) / 2) % n, i) = rng.sign() * rng.between(1, 2);
  } else if (input == Input::scaled) {
    return scaled(rng, A);
  } else if (input == Input::singular && n > 0) {
    A = (A * 64).array().round();  // to the last bit
    A.row(n - 1).setZero();
    if (n > 2) A.row(n - 1) = A.row(0) - 2 * A.row(1);
  }
  return A;
}

}  // namespace titop_test
