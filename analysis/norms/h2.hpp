#pragma once

#include <titop/graph/state_space.hpp>

namespace titop {

/// The H2 norm: root mean square of the outputs, all together, under white noise of unit intensity
/// at every input; the square root of the integral over all omega of |G(j omega)|^2 (Frobenius) / 2
/// pi. By the controllability Gramian [Zhou, Doyle, Glover 1996, ch. 4]. Unit: that of the outputs
/// per unit of an input, times sqrt(rad/s). `Derivatives::h2` has its derivatives by parameters.
/// Throws singular if it is infinite: a pole is not left of the axis, or there is a direct term;
/// size for matrices that do not fit each other, not_finite for entries that are not finite. All
/// poles of the model count, also unreachable and unobservable ones: System::state_space() is
/// minimal up to Options::minimize_up_to states. O(30 n^3).
double norm_h2(const StateSpace& model);

}  // namespace titop
