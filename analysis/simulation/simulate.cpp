#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <titop/analysis/simulation/held_law.hpp>
#include <titop/analysis/simulation/simulate.hpp>
#include <titop/analysis/simulation/steppers.hpp>
#include <titop/analysis/simulation/whole_steps.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/closed_form.hpp>

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

/// Number of steps; throws if `step` and `until` make no sense together.
Index steps_of(const Simulation& s) {
  const auto refuse = [&](const char* way_out) -> Index {
    throw Error(Code::bad_value,
                fmt::format("Simulation has step {} s until {} s", s.step, s.until), way_out);
  };
  if (!(s.step > 0) || !std::isfinite(s.step) || !(s.until >= 0) || !std::isfinite(s.until))
    return refuse("give a positive step, and an end that is not negative");
  const std::optional<double> steps = detail::whole_steps(s.until, s.step);
  if (!steps) return refuse("take an end that is a whole number of steps");
  if (*steps > detail::kMostSteps) return refuse("that is more than 1e9 steps");
  return static_cast<Index>(*steps);
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

/// One time: states, inputs, and their outputs and rates by the factors.
struct Now {
  Index step;
  bool last;
  const VectorXd &x, &u, &y, &xdot;
};

Quantity kind_of(const Graph& g, const Output& o) {
  if (o.terms.empty()) return Quantity::plain;
  const Term& t = o.terms.front();
  return t.of == Term::Of::position ? Quantity::position
         : t.of == Term::Of::rate   ? Quantity::velocity
                                    : g.signals[static_cast<std::size_t>(t.signal)].quantity;
}

/// Largest values of outputs, and how far they are off.
class OutputPeaks {
 public:
  explicit OutputPeaks(const detail::Factored& d)
      : d_(d), off_(VectorXd::Zero(std::ssize(d.layout().outputs))), size_(off_) {}

  void add(const VectorXd& y) { size_ = size_.cwiseMax(y.cwiseAbs()); }
  /// An output that is 0 by symmetry is rounding without digits: its size is at least a million
  /// times its rounding.
  void add_off(const Now& now, const VectorXd& off) {
    constexpr double kOfRounding = 1e6;
    const VectorXd rounding = instant(now.x, now.u).rounding().outputs().cwiseAbs();
    const VectorXd all = off.cwiseAbs() + by_relations(now);
    off_ = off_.cwiseMax(all.array().isFinite().select(all, HUGE_VAL).matrix());
    size_ = size_.cwiseMax(kOfRounding * rounding);
  }
  VectorXd outputs(const VectorXd& x, const VectorXd& u) const { return instant(x, u).outputs(); }

  /// If the states themselves are rounding, so are outputs that symmetry makes 0: they count as
  /// a millionth of the largest of their kind at least.
  VectorXd relative() const {
    constexpr double kOfKind = 1e-6;
    const std::vector<Output>& outputs = d_.graph().outputs;
    std::map<Quantity, double> largest;
    const auto rows = [&](std::size_t o) {
      return Eigen::seqN(d_.layout().output_first[o], outputs[o].size);
    };
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      double& of_kind = largest[kind_of(d_.graph(), outputs[o])];
      of_kind = std::max(of_kind, size_(rows(o)).maxCoeff());
    }
    VectorXd size = size_;
    for (std::size_t o = 0; o < outputs.size(); ++o)
      size(rows(o)) =
          size(rows(o)).cwiseMax(kOfKind * largest[kind_of(d_.graph(), outputs[o])]).eval();
    return (off_.array() > detail::kUnderflow).select(off_.cwiseQuotient(size), 0);
  }

 private:
  /// Rounding of the states that follow from others: near a singular posture of a closed chain they
  /// have fewer digits.
  VectorXd by_relations(const Now& now) const {
    if (d_.states.trivial()) return VectorXd::Zero(now.y.size());
    const VectorXd off = d_.states.rounding(d_.states.expanded(now.x, now.u));
    return instant_of_blocks(off, VectorXd::Zero(now.u.size())).outputs().cwiseAbs();
  }
  detail::Instant instant(const VectorXd& states, const VectorXd& u) const {
    return instant_of_blocks(d_.states.expanded(states, u), u);
  }
  detail::Instant instant_of_blocks(const VectorXd& all, const VectorXd& u) const {
    solve::RowMatrix<double> known(all.size() + u.size(), 1);
    known << all, u;
    return detail::Instant(d_, std::move(known), {}, solve::Refinement::settled);
  }

  const detail::Factored& d_;
  VectorXd off_, size_;
};

/// States on their way.
class TimeStepping {
 public:
  virtual ~TimeStepping() = default;
  /// Records the errors at this time; called once before each step and after the last.
  virtual void look(const Now&) {}
  virtual VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) = 0;
  /// See Trajectory::error.
  virtual VectorXd error() const { return {}; }
};

/// Steps by a rule that the caller chose.
class RuleStepping : public TimeStepping {
 public:
  explicit RuleStepping(std::unique_ptr<detail::StepRule> rule) : rule_(std::move(rule)) {}
  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) override {
    return rule_->step(x, u0, u1);
  }

 private:
  std::unique_ptr<detail::StepRule> rule_;
};

/// Takes the sample of this time, if there is one, of the law for a deviation of the states.
void sample(detail::HeldLaw& law, const OutputPeaks& outputs, const Now& now,
            const VectorXd& deviation) {
  if (!now.last && law.samples_at(now.step)) law.sample(outputs.outputs(deviation, law.inputs()));
}

/// Exact steps of the dense model. Its error by rounding of A and B is the difference of their xdot
/// from the factors', propagated by the same steps.
class Exact : public TimeStepping {
 public:
  Exact(const System& system, const detail::Factored& d, const detail::HeldLaw& law, double h,
        Index steps)
      : rule_(system, h),
        sizes_(d),
        law_(law),
        every_(std::max<Index>(1, (steps + kLooks - 1) / kLooks)),
        weight_(static_cast<double>(every_)),
        off_(VectorXd::Zero(system.order())) {}
  void look(const Now& now) override {
    sizes_.add(now.y);
    sample(law_, sizes_, now, off_);
    if (now.step % every_ != 0 && !now.last) return;
    sizes_.add_off(now, sizes_.outputs(off_, law_.inputs()));
    off_ += weight_ * rule_.of(rule_.xdot(now.x, now.u) - now.xdot);
  }
  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) override {
    VectorXd next = rule_.step(x, u0, u1, off_);
    if (!law_.inputs().isZero(0))
      off_ += rule_.step(VectorXd::Zero(x.size()), law_.inputs(), law_.inputs());
    return next;
  }
  VectorXd error() const override { return sizes_.relative(); }

 private:
  static constexpr Index kLooks = 1000;  ///< in one motion: a look costs as much as some steps
  detail::ExactRule rule_;
  OutputPeaks sizes_;
  detail::HeldLaw law_;  ///< of the deviation
  Index every_;
  double weight_;
  VectorXd off_;
};

/// Midpoint at half the step, against that at the step.
class Halved : public TimeStepping {
 public:
  Halved(const detail::Factored& d, const detail::HeldLaw& law, double h, VectorXd x0)
      : half_(detail::midpoint_rule(d, h / 2)),
        whole_(detail::midpoint_rule(d, h)),
        other_(std::move(x0)),
        sizes_(d),
        law_(law) {}
  void look(const Now& now) override {
    sizes_.add(now.y);
    sample(law_, sizes_, now, other_ - now.x);
    sizes_.add_off(now, sizes_.outputs(other_, now.u + law_.inputs()) - now.y);
  }
  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) override {
    other_ = whole_->step(other_, u0 + law_.inputs(), u1 + law_.inputs());
    const VectorXd u = (u0 + u1) / 2;
    return half_->step(half_->step(x, u0, u), u, u1);
  }
  VectorXd error() const override { return sizes_.relative(); }

 private:
  std::unique_ptr<detail::StepRule> half_, whole_;
  VectorXd other_;
  OutputPeaks sizes_;
  detail::HeldLaw law_;  ///< of the difference of `other_`
};

/// `exact`: by how much the exact step was off; negative if it was not tried.
void refuse_inaccurate(const System& system, const Simulation& s, const VectorXd& error,
                       double exact) {
  if (error.size() == 0) return;
  Index worst = 0;
  if (error.maxCoeff(&worst) <= s.accuracy) return;
  const std::string of_exact =
      exact >= 0
          ? fmt::format("Stepper::exact is off by {:.1e}, as A and B have few digits here", exact)
          : fmt::format(
                "Stepper::exact has no such error, at a cost of {0} x {0} x {0} operations once",
                system.order());
  throw Error(
      Code::bad_value,
      fmt::format("half of the step of {} s changes output {} by {:.1e} of its largest value",
                  s.step, system.outputs()[static_cast<std::size_t>(worst)], error(worst)),
      fmt::format("take smaller steps; {}; or accept the error by Simulation::accuracy or "
                  "Stepper::midpoint",
                  of_exact));
}

void refuse_overflow(const System& system, const Excitation& excitation, double time) {
  throw Error(Code::not_finite,
              fmt::format("the response of {} overflows at {} s", system.stage().graph.name, time),
              excitation.law()
                  ? "the loop with the sampled law is unstable: look at the law's sign and period, "
                    "and at margins(series(law, discretize(model, period)))"
                  : "look at its poles: it is unstable; stop earlier");
}

std::unique_ptr<TimeStepping> motion_of(const System& system, const detail::Factored& d,
                                        const detail::HeldLaw& law, const Simulation& s,
                                        Stepper stepper, Index steps, const VectorXd& x0) {
  switch (stepper) {
    case Stepper::rk4: return std::make_unique<RuleStepping>(detail::rk4_rule(system, s.step));
    case Stepper::midpoint:
      if (s.stepper == Stepper::midpoint)
        return std::make_unique<RuleStepping>(detail::midpoint_rule(d, s.step));
      return std::make_unique<Halved>(d, law, s.step, x0);
    default: return std::make_unique<Exact>(system, d, law, s.step, steps);
  }
}

Trajectory move(const System& system, const Excitation& excitation, detail::HeldLaw law,
                const Simulation& s, Stepper stepper, TimeStepping& motion, VectorXd x,
                Index steps) {
  Trajectory result;
  result.stepper = stepper;
  result.states = system.states();
  result.outputs = system.outputs();
  result.y.resize(std::ssize(result.outputs), steps + 1);
  result.x.resize(x.size(), s.keep_states ? steps + 1 : 1);
  VectorXd last = inputs_of(system, excitation, 0, s.step).first;
  for (Index k = 0;; ++k) {
    const double now = static_cast<double>(k) * s.step;
    Excitation::Ends u{last, {}};
    if (k < steps) u = inputs_of(system, excitation, now, static_cast<double>(k + 1) * s.step);
    last = u.second;
    if (k < steps && law.samples_at(k)) law.sample(system.apply(x, u.first + law.inputs()).y);
    law.add_to(u);
    result.time.push_back(now);
    const auto [xdot, y] = system.apply(x, u.first);
    result.y.col(k) = y;
    result.x.col(s.keep_states ? k : 0) = x;
    if (!x.allFinite() || !y.allFinite()) refuse_overflow(system, excitation, now);
    motion.look({k, k == steps, x, u.first, y, xdot});
    if (k == steps) break;
    x = motion.step(x, u.first, u.second);
    if (s.progress) s.progress(static_cast<std::size_t>(k + 1), static_cast<std::size_t>(steps));
  }
  result.error = motion.error();
  return result;
}

}  // namespace

Trajectory simulate(const System& system, const Excitation& excitation, const Simulation& s) {
  require_state_space(system.stage().graph);
  const Index steps = steps_of(s);
  const VectorXd x0 = start_of(system, s.x0);
  const detail::HeldLaw law(system, excitation, s.step);
  const auto by = [&](Stepper stepper) {
    const auto motion = motion_of(system, detail::data_of(system), law, s, stepper, steps, x0);
    return move(system, excitation, law, s, stepper, *motion, x0, steps);
  };
  if (s.stepper != Stepper::automatic) return by(s.stepper);
  double exact = -1;
  std::optional<Error> overflow;
  if (system.order() <= kExactUpTo) try {
      Trajectory t = by(Stepper::exact);
      exact = t.error.size() > 0 ? t.error.maxCoeff() : 0;
      if (exact <= s.accuracy) return t;
    } catch (const Error& error) {  // errors of A and B may grow in a stable system
      if (!error.has(Code::not_finite)) throw;
      overflow = error;
    }
  try {
    Trajectory halved = by(Stepper::midpoint);
    refuse_inaccurate(system, s, halved.error, exact);
    return halved;
  } catch (const Error&) {
    if (overflow) throw *overflow;  // midpoint does not contradict it
    throw;
  }
}

}  // namespace titop
