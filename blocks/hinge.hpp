#pragma once

#include <titop/graph/diagram.hpp>
#include <titop/graph/mount.hpp>

namespace titop {

/// Revolute joint about the unit vector along r, [Alazard 2015] eq. (18) as a separate massless
/// block, in the frame of the body that it carries:
///
///     xdd_C = xdd_P + [0; r] thetadd
///     F_P   = F_C                          (F_C: wrench by the carried body on the joint)
///     C_m   = r' T_C                       the 13th pair of scalars
///
/// With a body mounted on its child point this is G_PC = E M_PC E'. States: angle and rate; small
/// angles about the posture given by the mounting rotation.
///
/// Sign of the torque, as in the paper: C_m is the torque of the body ON its parent about r, so
/// `torque = k * angle + c * rate` is the stable spring-damper, and a motor that exerts tau on the
/// body is `torque = -tau`. Exactly one of `torque` and `accel` is driven: torque = 0 is a free
/// hinge, accel = 0 a locked one.
struct Hinge {
  Vector3d axis = Vector3d::UnitZ();  ///< r, any length but 0, in the joint's frame

  struct Handle {
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Children<6> child;            ///< mount of the body
    DualPort<6> parent;           ///< mount of the joint
    Port<1, Kind::accel> accel;   ///< thetadd [rad/s^2]
    Port<1, Kind::force> torque;  ///< C_m [N m]
    Reading angle;                ///< theta [rad]
    Reading rate;                 ///< thetad [rad/s]
  };
};
/// Throws bad_value if the axis has no direction.
BlockPtr as_block(const Hinge& spec);

/// Mounts `body` on the child point `site` through a hinge called `name`, about `axis` (in the
/// body's frame, which the joint shares), with T_ba the mounting rotation at angle 0, body to site.
/// The hinge's torque or acceleration must still be driven.
///
///     auto h = hinge(d, "drive", wing, hub.child("C1"), T_ba, {0, 1, 0});
///     h.torque = k * h.angle + c * h.rate - u;  // u: motor's torque on the wing
template <class Handle>
  requires HasParent<Handle, 6>
Hinge::Handle hinge(Diagram& d, std::string name, const Handle& body, const DualPort<6>& site,
                    const Rotation& T_ba, const Vector3d& axis,
                    SourceLine at = std::source_location::current()) {
  const Hinge::Handle joint = d.add(name, Hinge{axis}, at);
  detail::mount_through(joint, name, body, site, T_ba, at);
  return joint;
}

}  // namespace titop
