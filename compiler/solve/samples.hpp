#pragma once

#include <Eigen/Core>

/// Effect of rounding by samples. For the compiler's own files.
namespace titop::detail {

/// Numbers are perturbed by about one unit of their last place, up or down at random: the largest
/// change of four samples estimates the rounding of a result. Of four, hardly all are small.
inline constexpr int kSamples = 4;
/// Times that: values below may be rounding alone.
inline constexpr double kRoundingFactor = 32;

/// Largest magnitudes of `change(i)`, i = 0 to 3: the changes of a result in each sample.
template <class Change>
Eigen::MatrixXd largest_of_samples(const Change& change) {
  Eigen::MatrixXd most = change(0).cwiseAbs();
  for (int i = 1; i < kSamples; ++i) most = most.cwiseMax(change(i).cwiseAbs());
  return most;
}

/// Values below kRoundingFactor times their rounding become 0.
inline Eigen::MatrixXd cleared(const Eigen::MatrixXd& value, const Eigen::MatrixXd& rounding) {
  return (value.array().abs() <= kRoundingFactor * rounding.array()).select(0.0, value);
}

}  // namespace titop::detail
