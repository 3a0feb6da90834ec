#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/simulation/simulate.hpp>
#include <titop/analysis/simulation/whole_steps.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {
constexpr double kRounding = 1e-15;  ///< of a time that is a number of steps
}

Excitation Excitation::none() {
  return Excitation([](double, double) { return Ends{}; });
}

Excitation Excitation::step(VectorXd u) {
  return Excitation([u = std::move(u)](double, double) { return Ends{u, u}; });
}

Excitation Excitation::function(std::function<VectorXd(double)> u) {
  return Excitation([u = std::move(u)](double begin, double end) {
    return Ends{u(begin), u(end)};
  });
}

Excitation Excitation::held(MatrixXd samples, double period) {
  if (samples.cols() == 0)
    throw Error(Code::size, "Excitation::held has no sample", "give a column per period");
  if (!(period > 0) || !std::isfinite(period))
    throw Error(Code::bad_value, fmt::format("Excitation::held has period {} s", period),
                "give a positive period");
  return Excitation([samples = std::move(samples), period](double begin, double end) {
    // From inside the step: a step that crosses a sample is refused.
    const double from = begin / period, to = end / period, slack = detail::kOfStep + kRounding * to;
    const auto first = static_cast<Index>(std::floor(from + slack));
    if (to - static_cast<double>(first) > 1 + slack)
      throw Error(
          Code::bad_value,
          fmt::format("the step from {} to {} s crosses the sample at {} s", begin, end,
                      static_cast<double>(first + 1) * period),
          fmt::format("take Simulation::step = {} over a whole number",
                      period / std::max(1.0, std::ceil((1 - slack) * period / (end - begin)))));
    const VectorXd u = samples.col(std::clamp<Index>(first, 0, samples.cols() - 1));
    return Ends{u, u};
  });
}

Excitation Excitation::sampled(DiscreteModel law, Excitation more) {
  const StateSpace& m = law.model;
  require_fitting(m, "Excitation::sampled");
  require_names(m, "Excitation::sampled");
  if (!m.A.allFinite() || !m.B.allFinite() || !m.C.allFinite() || !m.D.allFinite())
    throw Error(Code::not_finite, "Excitation::sampled: the law is not finite",
                "give finite matrices");
  if (!(law.period > 0) || !std::isfinite(law.period))
    throw Error(Code::bad_value, fmt::format("Excitation::sampled has period {} s", law.period),
                "give a positive period");
  if (more.law_)
    throw Error(Code::bad_value, "Excitation::sampled: there are two laws",
                "write them as one law, with the inputs and outputs of both");
  more.law_ = std::make_shared<const DiscreteModel>(std::move(law));
  return more;
}

namespace {

/// The record at t, from the right where it jumps, or from the left. Times within `slack` are one.
VectorXd at_time(const std::vector<double>& times, const MatrixXd& samples, double t, double slack,
                 bool right) {
  const auto after = right ? std::upper_bound(times.begin(), times.end(), t + slack)
                           : std::lower_bound(times.begin(), times.end(), t - slack);
  if (after == times.begin()) return samples.col(0);
  if (after == times.end()) return samples.col(samples.cols() - 1);
  const Index i = after - times.begin();
  const double share = std::clamp((t - *(after - 1)) / (*after - *(after - 1)), 0.0, 1.0);
  return (1 - share) * samples.col(i - 1) + share * samples.col(i);
}

/// A jump inside a step would be smeared over it.
void refuse_jumps(const std::vector<double>& times, double begin, double end, double slack) {
  for (auto t = std::upper_bound(times.begin(), times.end(), begin + slack);
       t != times.end() && *t < end - slack; ++t)
    if (t + 1 != times.end() && *(t + 1) == *t)
      throw Error(
          Code::bad_value,
          fmt::format("the record jumps at {} s, inside the step from {} to {} s", *t, begin, end),
          "take a step that ends there");
}

}  // namespace

Excitation Excitation::recorded(std::vector<double> times, MatrixXd samples) {
  if (times.empty() || static_cast<Index>(times.size()) != samples.cols())
    throw Error(Code::size,
                fmt::format("Excitation::recorded has {} times and {} columns", times.size(),
                            samples.cols()),
                "give one column per time, at least one");
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && times[i] < times[i - 1]))
      throw Error(Code::bad_value,
                  fmt::format("Excitation::recorded: time {} is {}", i + 1, times[i]),
                  "give finite times that ascend");
  return Excitation(
      [times = std::move(times), samples = std::move(samples)](double begin, double end) {
        const double slack = detail::kOfStep * (end - begin) + kRounding * std::abs(end);
        refuse_jumps(times, begin, end, slack);
        return Ends{at_time(times, samples, begin, slack, true),
                    at_time(times, samples, end, slack, false)};
      });
}

}  // namespace titop
