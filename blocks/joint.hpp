#pragma once

#include <titop/blocks/axis.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/mount.hpp>

namespace titop {

/// Joint with any of the six degrees of freedom free; Hinge and Slide are special cases: a massless
/// block in the frame of the body that it carries, with the relative motion S q,
///
///     xdd_C = xdd_P + S qdd,   F_P = F_C,   Q = S' F_C
///
/// one column of S per axis: [0; r] for about(r), [r; 0] for along(r). All other directions are
/// locked. The axes must be independent, not necessarily orthogonal. States: the axes' positions q,
/// then their rates; small motions about the posture given by the mounting rotation, in which C and
/// P coincide (see Slide).
///
/// Each axis is a separate port with its name ("axis1", "axis2" ... if it has none). Signs as
/// with Hinge and Slide: Q is the force or torque of the body ON its parent, so
/// `a.force = k * a.position + c * a.rate` is the stable spring-damper.
struct Joint {
  std::vector<Axis> axes;

  /// One axis. Exactly one of `force` and `accel` is driven.
  struct AxisPorts {
    Port<1, Kind::accel> accel;  ///< qdd [m/s^2 or rad/s^2]
    Port<1, Kind::force> force;  ///< Q [N or N m]
    Reading position;            ///< q [m or rad]
    Reading rate;                ///< qd [m/s or rad/s]
  };

  class Handle {
   public:
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Children<6> child;   ///< mount of the body
    DualPort<6> parent;  ///< mount of the joint
    /// The axis of this name. Throws unknown_name with the valid names.
    AxisPorts axis(std::string_view name) const;

   private:
    Graph* graph_;
    int node_;
  };
};
/// Throws bad_value for no axes, an axis without direction, or one that depends on others;
/// duplicate_name.
BlockPtr as_block(const Joint& spec);

/// Axes of the usual joints; in the joint's frame.
std::vector<Axis> ball();                                             ///< "rx", "ry", "rz"
std::vector<Axis> universal(const Vector3d& r1, const Vector3d& r2);  ///< about r1 and r2
std::vector<Axis> cylindrical(const Vector3d& r);                     ///< "travel", "angle"
std::vector<Axis> planar(const Vector3d& normal);  ///< "angle" about it, "axis1", "axis2" across it

namespace detail {
/// Frees every axis that is not driven.
void release_axes(const Joint::Handle& joint, const Joint& spec, const SourceLine& at);
}  // namespace detail

/// Mounts `body` on the child point `site` through a joint called `name` with the free `axes` (in
/// the body's frame, which the joint shares), with T_ba the mounting rotation, body to site. An
/// axis without further equations moves freely: give it a spring-damper, drive it, or lock it.
///
///     auto g = joint(d, "gimbal", mirror, hub.child("M"), T_ba,
///                    {about({1, 0, 0}, "roll"), about({0, 1, 0}, "pitch")});
///     auto roll = g.axis("roll"), pitch = g.axis("pitch");
///     roll.force = k * roll.position + c * roll.rate;  // sprung
///     pitch.accel = u;                                 // driven; = 0 locks it
///
///     joint(d, "foot", strut, hub.child("F"), T_ba, ball());
template <class Handle>
  requires HasParent<Handle, 6>
Joint::Handle joint(Diagram& d, std::string name, const Handle& body, const DualPort<6>& site,
                    const Rotation& T_ba, const std::vector<Axis>& axes,
                    SourceLine at = std::source_location::current()) {
  const Joint spec{axes};
  const Joint::Handle result = d.add(name, spec, at);
  detail::mount_through(result, name, body, site, T_ba, at);
  detail::release_axes(result, spec, at);
  return result;
}

}  // namespace titop
