#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <titop/compiler/evaluate.hpp>
#include <titop/compiler/instant.hpp>
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

constexpr int kExactUpTo = 600;  ///< states: a second or so for the exponential

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

/// States on their way, some steps of the rule in each step that is asked for.
struct Motion {
  std::unique_ptr<detail::StepRule> rule;
  int per_step;
  VectorXd x;

  void step(const VectorXd& u0, const VectorXd& u1) {
    for (int i = 0; i < per_step; ++i) {
      const auto at = [&](int k) { return VectorXd(u0 + (u1 - u0) * k / per_step); };
      x = per_step == 1 ? rule->step(x, u0, u1) : rule->step(x, at(i), at(i + 1));
    }
  }
};

/// Outputs against those of steps of twice the size.
struct Halved {
  Motion twice;
  VectorXd off, size;

  /// What symmetry makes 0 is rounding, and has no digit to lose: an output counts as a million
  /// times its rounding at least.
  void compare(const detail::SystemData& d, const VectorXd& x, const VectorXd& y,
               const VectorXd& u) {
    constexpr double kOfRounding = 1e6;
    const auto instant = [&](const VectorXd& states) {
      const VectorXd all = d.states.expanded(states, u);
      solve::RowMatrix<double> known(all.size() + u.size(), 1);
      known << all, u;
      return detail::Instant(d, std::move(known));
    };
    const VectorXd rounding = instant(x).rounding().outputs().cwiseAbs();
    off = off.cwiseMax((instant(twice.x).outputs() - y).cwiseAbs());
    size = size.cwiseMax(y.cwiseAbs()).cwiseMax(kOfRounding * rounding);
  }
  VectorXd relative() const {
    return (off.array() > detail::kUnderflow).select(off.cwiseQuotient(size), 0);
  }
};

void refuse_inaccurate(const System& system, const Simulation& s, const VectorXd& error) {
  if (error.size() == 0) return;
  Index worst = 0;
  if (error.maxCoeff(&worst) <= s.accuracy) return;
  throw Error(
      Code::bad_value,
      fmt::format("half of the step of {} s changes output {} by {:.1e} of its largest value",
                  s.step, system.outputs()[static_cast<std::size_t>(worst)], error(worst)),
      fmt::format("take smaller steps; Stepper::exact is right at any step, once for {0} x {0} x "
                  "{0} operations; or say by Simulation::accuracy, or Stepper::midpoint, that it "
                  "is good enough",
                  system.order()));
}

void refuse_overflow(const System& system, double time) {
  throw Error(Code::not_finite,
              fmt::format("the response of {} overflows at {} s", system.stage().graph.name, time),
              "look at its poles: it is unstable; stop earlier");
}

Stepper chosen(const System& system, Stepper asked) {
  if (asked != Stepper::automatic) return asked;
  return system.order() <= kExactUpTo ? Stepper::exact : Stepper::midpoint;
}

}  // namespace

Trajectory simulate(const System& system, const Excitation& excitation, const Simulation& s) {
  const Index steps = steps_of(s);
  Trajectory result;
  result.stepper = chosen(system, s.stepper);
  result.states = system.states();
  result.outputs = system.outputs();
  const auto outputs = static_cast<Index>(result.outputs.size());
  result.y.resize(outputs, steps + 1);
  const bool halved = result.stepper != s.stepper && result.stepper != Stepper::exact;
  const auto rule = [&](double h) { return rule_of(system, *system.data_, result.stepper, h); };
  const VectorXd x0 = start_of(system, s.x0), none = VectorXd::Zero(outputs);
  Motion motion{rule(halved ? s.step / 2 : s.step), halved ? 2 : 1, x0};
  std::optional<Halved> other;
  if (halved) other = Halved{{rule(s.step), 1, x0}, none, none};
  result.x.resize(x0.size(), s.keep_states ? steps + 1 : 1);
  VectorXd last = inputs_of(system, excitation, 0, s.step).first;
  for (Index k = 0;; ++k) {
    const double now = static_cast<double>(k) * s.step;
    Excitation::Ends u{last, {}};
    if (k < steps) u = inputs_of(system, excitation, now, static_cast<double>(k + 1) * s.step);
    result.time.push_back(now);
    result.y.col(k) = system.apply(motion.x, u.first).y;
    result.x.col(s.keep_states ? k : 0) = motion.x;
    if (!motion.x.allFinite() || !result.y.col(k).allFinite()) refuse_overflow(system, now);
    if (other) other->compare(*system.data_, motion.x, result.y.col(k), u.first);
    if (k == steps) break;
    motion.step(u.first, u.second);
    if (other) other->twice.step(u.first, u.second);
    last = u.second;
  }
  if (result.stepper == Stepper::exact) result.error = none;
  if (other) result.error = other->relative();
  if (other) refuse_inaccurate(system, s, result.error);
  return result;
}

}  // namespace titop
