#pragma once

#include <titop/analysis/control/margins.hpp>
#include <titop/analysis/simulation/discrete_model.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <titop/graph/state_space.hpp>

/// Models at equal steps: x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k).
namespace titop {

/// How a continuous model becomes a discrete one.
enum class Discretization {
  zero_order_hold,   ///< exact for inputs held over each step, as by a digital controller
  first_order_hold,  ///< exact for inputs that are linear in each step; u(k + 1) is known at k + 1
  tustin             ///< s = c (z - 1) / (z + 1): for laws and filters; no aliasing, stays stable
};

/// The model at this period [s]. Holds by `hold` (analysis/simulation/hold.hpp), the first-order
/// one from the ramp response [Franklin, Powell, Workman, Digital Control of Dynamic
/// Systems, 6.3.2]; Tustin's c is 2 / period, or with `prewarp` [rad/s] the value at which both
/// responses agree at this frequency, prewarp / tan(prewarp period / 2). Throws bad_value for a
/// period that is not positive and finite, for a prewarp below 0, at pi / period or above, or
/// without Tustin; size for matrices that do not fit; singular if c is a pole of the model. O(n^3).
///
///     const DiscreteModel law = discretize(continuous, 0.01, Discretization::tustin, 20);
DiscreteModel discretize(const StateSpace& model, double period,
                         Discretization method = Discretization::zero_order_hold,
                         double prewarp = 0);

/// The series connection, from the inputs of `first` to the outputs of `second`. The loop transfer
/// of a continuous plant with a discrete law is series(law, discretize(plant, period)). Throws size
/// if the outputs of the first are not as many as the inputs of the second, bad_value for different
/// periods.
DiscreteModel series(const DiscreteModel& first, const DiscreteModel& second);

/// Margins of a discrete loop transfer: exactly those of L on the unit circle, by w = (2 / period)
/// (z - 1) / (z + 1), which maps it on the axis; frequencies are omega of z = exp(j omega period),
/// pi / period at most. LoopMargins::delay is the phase margin over omega: exact for
/// delays of whole periods. Throws as `margins`, and singular if L has a pole at z = -1.
Margins margins(const DiscreteModel& L);

/// The Pade approximation of a delay [s] of this order: all-pass, exp(-s delay) with an error of
/// order (s delay)^(2 order + 1), states scaled to the delay; for use in a diagram. Throws
/// bad_value for a delay that is not positive and finite, and for an order below 1 or above 10 (its
/// coefficients lose all digits beyond).
///
///     auto late = d.add("late", pade(0.02, 2));
Lti pade(double delay, int order);

}  // namespace titop
