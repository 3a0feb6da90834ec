#pragma once

#include <titop/blocks/axis.hpp>
#include <titop/graph/diagram.hpp>

namespace titop {

/// Angular momentum h a of a rotor that spins at constant speed inside of the body of this port,
/// about the unit vector a along `axis` (fixed in the body, in the port's frame): the gyroscopic
/// torque on the body, for small motions,
///
///     T = -omega x (h a) = h a x omega       [N m]
///
/// with omega the body's angular rate, `port.rate.angular()`. The torque acts at a child point or
/// at the parent point; a torque may be moved freely within a rigid body. At a child point of a
/// flexible body omega is the rate there, with that of its modes. The rotor's mass and
/// transverse inertia must be included in those of the body; `Rotor` adds its own. h [N m s],
/// positive by the right hand about `axis`; it may be a parameter (two occurrences in `lft`). Rates
/// that no state determines add integrators, as with every reading of a rate. Writes two equations,
/// with b x c = a,
///     port.force.angular.along(c) += h * port.rate.angular().along(b);
///     port.force.angular.along(b) += -h * port.rate.angular().along(c);
/// with the other signs at a parent point. `port.reaction` contains the torque, `port.force` of a
/// parent point does not. A parent point without an equation stays free, as with any `+=`. Throws
/// bad_value for an axis without direction, not_finite for an h or an axis that is not finite,
/// unknown_name for a port of no diagram. O(1).
///
///     momentum(hub.child("B"), 50.0, {0, 1, 0});  // 50 N m s about the hub's y axis
void momentum(const DualPort<6>& port, const Value& h, const Vector3d& axis,
              SourceLine at = std::source_location::current());

}  // namespace titop
