#pragma once

#include <titop/graph/diagram.hpp>
#include <titop/graph/mount.hpp>

namespace titop {

/// Prismatic joint along the unit vector of r: the Hinge's counterpart, a separate massless block
/// in the frame of the body that it carries:
///
///     xdd_C = xdd_P + [r; 0] xdd
///     F_P   = F_C                          (F_C: wrench by the carried body on the joint)
///     f     = r' f_C                       the 13th pair of scalars
///
/// States: travel x and rate; small motions about the posture. C and P coincide in it: the travel
/// of the slide at the posture belongs to the geometry, to the child point of the parent body or to
/// the carried body's own points (`posture` computes it).
///
/// Sign of the force, as with the hinge's torque: f is the force of the body ON its parent along r,
/// so `force = k * travel + c * rate` is the stable spring-damper, and an actuator that pushes the
/// body by u is `force = -u`. Exactly one of `force` and `accel` is driven: force = 0 slides
/// freely, accel = 0 is locked.
struct Slide {
  Vector3d axis = Vector3d::UnitZ();  ///< r, any length but 0, in the joint's frame

  struct Handle {
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Children<6> child;           ///< mount of the body
    DualPort<6> parent;          ///< mount of the joint
    Port<1, Kind::accel> accel;  ///< xdd [m/s^2]
    Port<1, Kind::force> force;  ///< f [N]
    Reading travel;              ///< x [m]
    Reading rate;                ///< xd [m/s]
  };
};
/// Throws bad_value if the axis has no direction.
BlockPtr as_block(const Slide& spec);

/// Mounts `body` on the child point `site` through a slide called `name`, along `axis` (in the
/// body's frame, which the joint shares), with T_ba the mounting rotation, body to site. The
/// slide's force or acceleration must still be driven.
///
///     auto s = slide(d, "jack", mast, hub.child("C1"), T_ba, {1, 0, 0});
///     s.force = k * s.travel + c * s.rate - u;  // u: actuator's force on the mast
template <class Handle>
  requires HasParent<Handle, 6>
Slide::Handle slide(Diagram& d, std::string name, const Handle& body, const DualPort<6>& site,
                    const Rotation& T_ba, const Vector3d& axis,
                    SourceLine at = std::source_location::current()) {
  const Slide::Handle joint = d.add(name, Slide{axis}, at);
  detail::mount_through(joint, name, body, site, T_ba, at);
  return joint;
}

}  // namespace titop
