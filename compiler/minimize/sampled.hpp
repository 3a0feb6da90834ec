#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

/// What rounding does to whatever is made of a model, seen by samples of it. For the compiler's own
/// files.
namespace titop::modes {

/// Times the largest of a few samples of rounding: what is below may be nothing else.
inline constexpr double kRounding = 32;

/// A model, and as it might be as well: rounding of the given sizes added to its entries.
struct Sampled {
  StateSpace model;
  std::vector<StateSpace> off;
};
/// `rounding`: of every entry; empty: 2.2e-16 of it. Four samples from fixed seeds.
Sampled sampled(const StateSpace& model, const StateSpace& rounding);

/// Largest deviation from `value` among what `f` makes of the samples. They show what rounding of
/// the entries does; where sums cancel, the sum's own may be more, and be the same in all.
template <class Sample, class F>
Eigen::MatrixXd rounding_of(const std::vector<Sample>& samples, const Eigen::MatrixXd& value,
                            const F& f) {
  Eigen::MatrixXd most = Eigen::MatrixXd::Zero(value.rows(), value.cols());
  for (const Sample& off : samples) most = most.cwiseMax((f(off) - value).cwiseAbs());
  return most;
}

/// 0 for what lies below kRounding times this rounding.
Eigen::MatrixXd cleared(const Eigen::MatrixXd& value, const Eigen::MatrixXd& rounding);

/// Entries of the model that rounding alone may have made become 0.
void clear_rounding(Sampled& sampled);

/// Coefficients as a sample has them, which were solved for: they have rounding of their own.
Eigen::MatrixXd jittered(Eigen::MatrixXd T, int sample);

}  // namespace titop::modes
