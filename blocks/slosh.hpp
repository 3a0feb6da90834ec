#pragma once

#include <titop/blocks/joint.hpp>
#include <titop/graph/diagram.hpp>

namespace titop {

/// One lateral mode of a liquid in a tank under constant thrust: a point mass on springs across the
/// thrust axis that moves with the tank along it [Abramson 1966, NASA SP-106, ch. 6]. A pendulum of
/// length l under the acceleration g of the thrust is the same: stiffness m g / l, at the place of
/// its mass at rest. The thrust itself is not in the linear model.
struct Slosh {
  Value mass = 0;                     ///< of the mode [kg]
  Value stiffness = 0;                ///< mass times the square of its frequency [N/m]
  Value damping = 0;                  ///< [N s/m]
  Vector3d axis = Vector3d::UnitZ();  ///< of the thrust, any length but 0, in the frame of the tank
};

/// Puts the mode at the child point `site` of a body: a RigidBody `name` without inertia on a joint
/// `name` + " springs" with the axes "b" and "c" across `axis`, b x c along it. Their positions are
/// the liquid's motion against the tank [m]. Values may be parameters. Throws bad_value for an axis
/// without direction and bad_inertia for a negative mass; `compile` reports duplicate_name. O(1).
///
///     auto fuel = slosh(d, "fuel", hub.child("tank"),
///                       {.mass = 60, .stiffness = 10, .damping = 0.2});
///     d.output("level") = fuel.axis("b").position;
Joint::Handle slosh(Diagram& d, const std::string& name, const DualPort<6>& site, const Slosh& spec,
                    SourceLine at = std::source_location::current());

}  // namespace titop
