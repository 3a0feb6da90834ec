#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

/// Effect of rounding on quantities derived from a model, by samples. For the compiler's own files.
namespace titop::detail {

/// Factor on the largest of a few samples of rounding: values below may be rounding alone.
inline constexpr double kRoundingFactor = 32;

/// A model, and samples of it with rounding of the given sizes added to its entries.
struct Sampled {
  StateSpace model;
  std::vector<StateSpace> off;
};
/// `rounding`: of every entry; empty: 2.2e-16 of it. Four samples from fixed seeds.
Sampled sampled(const StateSpace& model, const StateSpace& rounding);

/// Largest deviation from `value` among the values of `f` for the samples. It is the effect of
/// rounding of the entries; if sums cancel, the sum's own rounding may be larger, and the same in
/// all.
template <class Sample, class F>
Eigen::MatrixXd rounding_of(const std::vector<Sample>& samples, const Eigen::MatrixXd& value,
                            const F& f) {
  Eigen::MatrixXd most = Eigen::MatrixXd::Zero(value.rows(), value.cols());
  for (const Sample& off : samples) most = most.cwiseMax((f(off) - value).cwiseAbs());
  return most;
}

/// Sets values below kRoundingFactor times this rounding to 0.
Eigen::MatrixXd cleared(const Eigen::MatrixXd& value, const Eigen::MatrixXd& rounding);

/// Sets entries of the model at rounding level to 0.
void clear_rounding(Sampled& sampled);

/// Solved coefficients of a sample, with their own rounding added.
Eigen::MatrixXd jittered(Eigen::MatrixXd T, int sample);

}  // namespace titop::detail
