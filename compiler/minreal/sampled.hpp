#pragma once

#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Effect of rounding on quantities derived from a model, by samples. For the compiler's own files.
namespace titop::detail {

/// A model, and samples of it with rounding of the given sizes added to its entries.
struct Sampled {
  StateSpace model;
  std::vector<StateSpace> off;
};
/// `rounding`: of every entry; empty: 2.2e-16 of it. From fixed seeds.
Sampled sampled(const StateSpace& model, const StateSpace& rounding);

/// Largest deviation from `value` among the values of `f` for the samples. It is the effect of
/// rounding of the entries; if sums cancel, the sum's own rounding may be larger, and the same in
/// all.
template <class Sample, class F>
Eigen::MatrixXd rounding_of(const std::vector<Sample>& samples, const Eigen::MatrixXd& value,
                            const F& f) {
  return largest_of_samples(
      [&](int i) { return Eigen::MatrixXd(f(samples[static_cast<std::size_t>(i)]) - value); });
}

/// Sets entries of the model at rounding level to 0.
void clear_rounding(Sampled& sampled);

/// Solved coefficients of a sample, with their own rounding added.
Eigen::MatrixXd jittered(Eigen::MatrixXd T, int sample);

}  // namespace titop::detail
