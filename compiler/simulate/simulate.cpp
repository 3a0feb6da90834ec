#include <fmt/format.h>

#include <cmath>
#include <titop/compiler/simulate.hpp>
#include <titop/compiler/simulate/steppers.hpp>

namespace titop {

using Eigen::Index;
using Eigen::VectorXd;

const char* to_string(Stepper stepper) {
  switch (stepper) {
    case Stepper::automatic: return "automatic";
    case Stepper::exact: return "exact";
    case Stepper::midpoint: return "midpoint";
    case Stepper::rk4: return "rk4";
  }
  return "stepper";
}

namespace {

constexpr int kExactUpTo =
    200;  ///< states: beyond, a dense step costs more than one by the factors

/// Number of steps; throws where `step` and `until` make no sense together.
Index steps_of(const Simulation& s) {
  const auto refuse = [&](const char* way_out) -> Index {
    throw Error(Code::bad_value,
                fmt::format("Simulation has step {} s until {} s", s.step, s.until), way_out);
  };
  if (!(s.step > 0) || !std::isfinite(s.step) || !(s.until >= 0) || !std::isfinite(s.until))
    return refuse("give a positive step, and an end that is not negative");
  const double steps = s.until / s.step, whole = std::round(steps);
  if (std::abs(steps - whole) > 1e-9 * std::max(1.0, whole))
    return refuse("take an end that is a whole number of steps");
  if (whole > 1e9) return refuse("that is more than 1e9 steps");
  return static_cast<Index>(whole);
}

VectorXd start_of(const System& system, const VectorXd& x0) {
  if (x0.size() == 0) return VectorXd::Zero(system.order());
  if (x0.size() != system.order())
    throw Error(Code::size, fmt::format("Simulation::x0 has {} entries", x0.size()),
                fmt::format("{} has {} states: System::states() names them",
                            system.stage().graph.name, system.order()));
  if (!x0.allFinite())
    throw Error(Code::not_finite, "Simulation::x0 is not finite", "give finite numbers");
  return x0;
}

/// Inputs at both ends of a step, checked; none counts as 0.
Excitation::Ends inputs_of(const System& system, const Excitation& excitation, double begin,
                           double end) {
  const auto m = static_cast<Index>(system.inputs().size());
  Excitation::Ends ends = excitation(begin, end);
  for (VectorXd* u : {&ends.first, &ends.second}) {
    if (u->size() == 0) *u = VectorXd::Zero(m);
    if (u->size() != m)
      throw Error(
          Code::size, fmt::format("the excitation gives {} inputs at {} s", u->size(), begin),
          fmt::format("{} has {}: System::inputs() names them", system.stage().graph.name, m));
    if (!u->allFinite())
      throw Error(Code::not_finite, fmt::format("the excitation is not finite at {} s", begin),
                  "look at the samples, or at the function");
  }
  return ends;
}

std::unique_ptr<detail::StepRule> rule_of(const System& system, const detail::SystemData& data,
                                          Stepper stepper, double h) {
  switch (stepper) {
    case Stepper::rk4: return detail::rk4_rule(system, h);
    case Stepper::midpoint: return detail::midpoint_rule(data, h);
    default: return detail::exact_rule(system, h);
  }
}

}  // namespace

Trajectory simulate(const System& system, const Excitation& excitation, const Simulation& s) {
  const Index steps = steps_of(s);
  VectorXd x = start_of(system, s.x0);
  Trajectory result;
  result.stepper = s.stepper != Stepper::automatic ? s.stepper
                   : system.order() <= kExactUpTo  ? Stepper::exact
                                                   : Stepper::midpoint;
  result.states = system.states();
  result.outputs = system.outputs();
  result.y.resize(static_cast<Index>(result.outputs.size()), steps + 1);
  result.x.resize(x.size(), s.keep_states ? steps + 1 : 1);
  const auto rule = rule_of(system, *system.data_, result.stepper, s.step);
  VectorXd last = inputs_of(system, excitation, 0, s.step).first;
  for (Index k = 0;; ++k) {
    const double now = static_cast<double>(k) * s.step;
    Excitation::Ends u{last, {}};
    if (k < steps) u = inputs_of(system, excitation, now, static_cast<double>(k + 1) * s.step);
    result.time.push_back(now);
    result.y.col(k) = system.apply(x, u.first).y;
    result.x.col(s.keep_states ? k : 0) = x;
    if (!x.allFinite() || !result.y.col(k).allFinite())
      throw Error(
          Code::not_finite,
          fmt::format("the response of {} overflows at {} s", system.stage().graph.name, now),
          "look at its poles: it is unstable; stop earlier");
    if (k == steps) return result;
    x = rule->step(x, u.first, u.second);
    last = u.second;
  }
}

}  // namespace titop
