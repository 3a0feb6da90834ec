#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <titop/graph/state_space.hpp>

/// Comparisons without an absolute floor: only digits count, in any units. Compare the result with
/// `<=`, so that not-a-number fails.
namespace titop_test {

/// |a - b| / |b|; 0 if both are 0, infinite if only b is.
template <class T>
double relative(const T& a, const T& b) {
  const auto off = static_cast<double>(std::abs(a - b));
  return off == 0 ? 0 : off / static_cast<double>(std::abs(b));
}

/// Worst entry of |a - b|, each over the geometric mean of the largest entries of its row and of
/// its column in b, so that every row and column may have its own unit. Infinite for different
/// shapes and for entries that should be 0 because their row or column is.
template <class A, class B>
double matrix_error(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols() || !a.allFinite()) return HUGE_VAL;
  double worst = 0;
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      const double off = std::abs(a(i, j) - b(i, j));
      const double size =
          std::sqrt(b.row(i).cwiseAbs().maxCoeff()) * std::sqrt(b.col(j).cwiseAbs().maxCoeff());
      if (off > 0) worst = std::max(worst, off / size);
    }
  return worst;
}

/// "" if both models have the same names in the same order and the same entries to the last bit.
inline std::string difference(const titop::StateSpace& a, const titop::StateSpace& b) {
  if (a.states != b.states) return "states";
  if (a.inputs != b.inputs) return "inputs";
  if (a.outputs != b.outputs) return "outputs";
  return a.A != b.A ? "A" : a.B != b.B ? "B" : a.C != b.C ? "C" : a.D != b.D ? "D" : "";
}

}  // namespace titop_test
