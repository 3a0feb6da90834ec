#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <titop/analysis/simulation/discrete_model.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

/// Time responses of a compiled system.
namespace titop {

/// The inputs over time, given by their values at the two ends of each step, as limits from inside.
/// All methods interpolate linearly in between, so that steps, samples and ramps are exact. A
/// vector u has the order of System::inputs(), an empty one is 0; matrices are inputs x samples.
class Excitation {
 public:
  /// u(begin), u(end) of the step from begin to end [s], limits from inside. With
  /// Stepper::automatic it may be called twice for the same step: it must return the same values.
  using Ends = std::pair<Eigen::VectorXd, Eigen::VectorXd>;
  using Over = std::function<Ends(double begin, double end)>;

  explicit Excitation(Over over) : over_(std::move(over)) {}
  Ends operator()(double begin, double end) const { return over_(begin, end); }

  /// All inputs are 0: the free motion from Simulation::x0.
  static Excitation none();
  /// u from time 0 on.
  static Excitation step(Eigen::VectorXd u);
  /// Any function of time [s] without jumps inside a step; taken as linear in every step.
  static Excitation function(std::function<Eigen::VectorXd(double)> u);
  /// Samples held for `period` [s] each, as by a digital controller: column k from k * period on,
  /// the last one for ever. Periods must be whole numbers of steps (`simulate` throws bad_value,
  /// with the steps that fit). Throws bad_value for a period that is not positive, size for no
  /// sample.
  static Excitation held(Eigen::MatrixXd samples, double period);
  /// A record: column k at times[k], ascending, linear in between, constant before and after. Two
  /// equal times make a jump, at which a step must end (else `simulate` throws bad_value). Throws
  /// size, bad_value.
  static Excitation recorded(std::vector<double> times, Eigen::MatrixXd samples);
  /// A discrete law in the loop, as of a digital controller: at the times k * period
  ///
  ///     u(k) = C x(k) + D y(k),   x(k + 1) = A x(k) + B y(k),   x(0) = 0
  ///
  /// and u is held until the next sample. y are the outputs just before u changes, after a jump of
  /// `more`. The law's inputs are outputs of the system, its outputs inputs of the system, by their
  /// names; the sign of the feedback is the law's own, a delay of whole periods some states of it.
  /// The values of `more` are added to those of the law. `simulate` throws unknown_name for names
  /// that the system does not have, bad_value if the period is not a whole number of steps. Throws
  /// size for matrices that do not fit each other or the names, not_finite, bad_value for a period
  /// that is not positive and for a second law in `more`.
  ///
  ///     const DiscreteModel law = discretize(pd, 0.1, Discretization::tustin);
  ///     simulate(system, Excitation::sampled(law), {.step = 0.02, .until = 60});
  static Excitation sampled(DiscreteModel law, Excitation more = none());

  /// The law of `sampled`, null of others. Valid as long as the Excitation.
  const DiscreteModel* law() const { return law_.get(); }

 private:
  Over over_;
  std::shared_ptr<const DiscreteModel> law_ = {};
};

/// Method of a step. Cost per step of n states, b bodies; error per unit of time of steps h.
enum class Stepper {
  automatic,  ///< exact up to 600 states; beyond, and if A and B have lost the digits of slow
              ///< motion, midpoint at half the step; its difference from midpoint at the step is
              ///< Trajectory::error, at three times the cost of midpoint
  exact,      ///< matrix exponential, once O(n^3), then O(n^2): for inputs that are linear in every
              ///< step no error at any step but rounding, that of writing A and B included
  midpoint,   ///< implicit midpoint rule through the factors, O(b), h^2: stable at any step, keeps
              ///< the energy of undamped systems; high modes stay bounded, with a phase lag
  rk4         ///< classic Runge-Kutta, O(b), h^4: refuses steps beyond its limit of stability
};
const char* to_string(Stepper stepper);

/// Settings of `simulate`.
struct Simulation {
  double step = 0;   ///< [s]
  double until = 0;  ///< [s]: a whole number of steps
  Stepper stepper = Stepper::automatic;
  Eigen::VectorXd x0 = {};   ///< states at time 0, in the order of System::states(); none: 0
  bool keep_states = false;  ///< Trajectory::x at all times
  /// The largest Trajectory::error that the automatic choice accepts; above it the exact stepper is
  /// replaced by midpoint. Use infinity for outputs that no motion has reached yet (far down a
  /// chain): no digit of them is correct.
  double accuracy = 0.01;
  /// Called with (done, all) after each step: `progress_line()` draws it. From the beginning again
  /// if the automatic choice replaces the exact stepper by midpoint.
  std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Result of `simulate`, a column per time.
struct Trajectory {
  std::vector<double> time;  ///< [s]: 0, step, ..., until
  Eigen::MatrixXd y;         ///< outputs x times; where an input jumps, just after it (the last
                             ///< time: just before)
  Eigen::MatrixXd x;         ///< states x times, or their last column alone
  Stepper stepper = Stepper::exact;  ///< the stepper used
  /// Estimated error per output, relative to its largest value, or to a millionth of that of the
  /// largest output of its kind (positions, velocities, accelerations, forces) if that is more: an
  /// output that is 0 by symmetry has no correct digit. Of the automatic choice's midpoint: the
  /// largest change from steps of twice the size (an h^2 method: about three times the error). Of
  /// the exact stepper: the effect of rounding in A and B, from the difference of their xdot from
  /// that of the factors (sampled at up to a thousand times), propagated by the same steps, its
  /// order of magnitude. Both with the rounding of dependent states, which near a singular posture
  /// of a closed chain have few digits. Empty if midpoint or rk4 was chosen by the caller: no
  /// second run is made.
  Eigen::VectorXd error;
  std::vector<std::string> states, outputs;
};

/// The response of the system (its states, before `minimize`: x0 keeps its meaning) from x0 to
/// `excitation`. Throws bad_value for steps that are not positive or do not divide `until`, and for
/// an rk4 step beyond the limit of stability, which it names, and if the error of the automatic
/// choice exceeds Simulation::accuracy, with the output; size for x0 or inputs of another size;
/// singular if the equations of a midpoint step, for unit inputs, are not solved to the rounding of
/// their terms; not_finite if the response overflows (an unstable system), with the time. Cost:
/// that of the Stepper, and of its step times the number of steps.
///
/// Sources: [Hairer, Lubich, Wanner 2006] IV.2 (midpoint), [Van Loan 1978] (exponential).
Trajectory simulate(const System& system, const Excitation& excitation,
                    const Simulation& simulation);

/// The largest step [s] that rk4 may take: where h * (every stable pole) stays in its region of
/// stability |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 (2.83 / omega of an undamped pole, 2.79 / sigma
/// of a real one); infinite without poles. Unstable poles do not count. Throws the errors of
/// System::write. O(n^3).
double rk4_limit(const System& system);

}  // namespace titop
