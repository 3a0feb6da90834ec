#pragma once

#include <titop/graph/port.hpp>

/// The usual ways to drive a parent channel. Each writes the equations that one could write by
/// hand, with the caller's source line.
namespace titop {

/// A handle with a parent channel of N degrees of freedom.
template <class Handle, int N>
concept HasParent = requires(const Handle& body) {
  { body.parent } -> std::convertible_to<DualPort<N>>;
};

namespace detail {
/// child.accel = T_ba^-1 site.accel, site.force += sign * T_ba child_force. The frames of T_ba are
/// named after the two nodes if it has no names of its own.
void mount(SignalRef child_accel, SignalRef child_force, SignalRef site_accel, SignalRef site_force,
           const Rotation& T_ba, const SourceLine& at, double sign = 1);
void drive_by_zero(SignalRef signal, bool accumulate, const SourceLine& at);
}  // namespace detail

/// Fixes `body` (frame a, at its parent point P) to the child point `site` of another body (frame
/// b): equal accelerations there, and the body's reaction acts on the site. T_ba: components in
/// frame a to components in frame b.
///     body.parent.accel = T_ba^-1 * site.accel;   site.force += T_ba * body.parent.reaction;
/// A wrench that the user adds to body.parent.force acts from outside on the body: `+= -U` is a
/// wrench U. Throws unknown_name for ports of two diagrams; `compile` reports two_equations, frame,
/// and, if a chain closes, kinematic_loop. O(1).
template <class Handle>
  requires HasParent<Handle, 6>
void mount(const Handle& body, const DualPort<6>& site, const Rotation& T_ba = {},
           SourceLine at = std::source_location::current()) {
  detail::mount(body.parent.accel, body.parent.reaction, site.accel, site.force, T_ba, at);
}

/// The same on a single axis: body.parent.accel = site.accel; site.force += body.parent.reaction.
/// The site may be one axis of a point with six degrees of freedom: `mount(z,
/// hub.child("C").along(r))` mounts a spring-mass that moves along r, `.about(r)` one that rotates
/// about r (then with an inertia [kg m^2] for a mass). Its mass acts along r only.
template <class Handle>
  requires HasParent<Handle, 1>
void mount(const Handle& body, const DualPort<1>& site,
           SourceLine at = std::source_location::current()) {
  detail::mount(body.parent.accel, body.parent.reaction, site.accel, site.force, {}, at);
}

namespace detail {
/// The rotation to a body, whose parent's acceleration this is, as one to the joint of this name on
/// which the body is mounted, in the body's frame. Notes a mistake if it is named after another
/// block.
Rotation to_joint(const Rotation& T_ba, const SignalRef& body_accel, const std::string& joint,
                  const SourceLine& at);

/// Mounts `body` on `site` through the joint of this name, in whose frame the body is.
template <class Joint, class Handle>
void mount_through(const Joint& joint, const std::string& name, const Handle& body,
                   const DualPort<6>& site, const Rotation& T_ba, const SourceLine& at) {
  mount(joint, site, to_joint(T_ba, body.parent.accel, name, at), at);
  mount(body, joint.child, {}, at);
}
}  // namespace detail

/// Joins two child points, `point` of a body (frame a) and `site` of another (frame b): same
/// motion, opposite wrenches. Use it to close a chain: both bodies are mounted already. Errors as
/// of mount.
///     point.accel = T_ba^-1 * site.accel;   site.force += -(T_ba * point.reaction);
inline void weld(const DualPort<6>& point, const DualPort<6>& site, const Rotation& T_ba = {},
                 SourceLine at = std::source_location::current()) {
  detail::mount(point.accel, point.reaction, site.accel, site.force, T_ba, at, -1);
}

/// The same on a single axis.
inline void weld(const DualPort<1>& point, const DualPort<1>& site,
                 SourceLine at = std::source_location::current()) {
  detail::mount(point.accel, point.reaction, site.accel, site.force, {}, at, -1);
}

/// Fixes this point to the inertial frame: accel = 0. Also one axis of it, the others left to be
/// driven or released: `ground(beam.parent.along({0, 0, 1}))`. `compile` reports two_equations.
/// O(1).
template <int N>
void ground(const DualPort<N>& point, SourceLine at = std::source_location::current()) {
  detail::drive_by_zero(point.accel, /*accumulate=*/false, at);
}
template <class Handle>
  requires(HasParent<Handle, 6> || HasParent<Handle, 1>)
void ground(const Handle& body, SourceLine at = std::source_location::current()) {
  ground(body.parent, at);
}

/// Leaves the undriven directions of this point free: the wrench there is the sum of the terms
/// added by `+=`, else 0. After `b.parent.accel.linear = 0; release(b);` the body is pinned at P.
/// `compile` reports two_equations. O(1).
template <int N>
void release(const DualPort<N>& point, SourceLine at = std::source_location::current()) {
  detail::drive_by_zero(point.force, /*accumulate=*/true, at);
}
template <class Handle>
  requires(HasParent<Handle, 6> || HasParent<Handle, 1>)
void release(const Handle& body, SourceLine at = std::source_location::current()) {
  release(body.parent, at);
}

}  // namespace titop
