#pragma once

#include <string>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/graph/mount.hpp>
#include <vector>

/// Edges of flexible bodies as interfaces: the six channels at the middle of a line and one scalar
/// channel for each of its shapes.
namespace titop {

/// A line of a body, `panel.line("next")`.
struct LinePort {
  std::string name;                      ///< "p1.next"
  DualPort<6> point;                     ///< the child at its middle, or the parent
  bool is_parent = false;                ///< the body hangs on it
  ModalLine line;                        ///< axis, length and shapes; Phi is empty
  std::vector<DualPort<1>> shape_ports;  ///< one per shape

  /// The channel of this shape. Throws unknown_name with those that the line has.
  DualPort<1> shape(const LineShape& shape) const;
};

/// Ports of a flexible body: those of a body, and its lines.
struct FlexibleBodyHandle : BodyHandle {
  FlexibleBodyHandle(Graph* graph, int node);
  FlexibleBodyHandle(const FlexibleBodyHandle&) = default;
  FlexibleBodyHandle& operator=(const FlexibleBodyHandle& other) {
    return detail::rebind(*this, other);
  }
  /// The line of this name, of a child or of the parent. Throws unknown_name with those it has.
  LinePort line(const std::string& name) const;

 private:
  Graph* graph_;
  int node_;
};

/// Fixes the whole line to the inertial frame: its point, and its shapes at 0. `ground(panel)`
/// fixes the point of a parent's line alone, and its shapes remain free: `compile` warns of it.
void ground(const LinePort& line, SourceLine at = std::source_location::current());

/// Fixes the whole line, which must be its body's parent, to a rigid point: `mount` of the body
/// there, and its shapes at 0. T_ba: as of mount. Throws bad_value for the line of a child.
void mount(const LinePort& line, const DualPort<6>& site, const Rotation& T_ba = {},
           SourceLine at = std::source_location::current());

/// The same for any line: of a child by `weld` of its point, as for closing a chain.
void weld(const LinePort& line, const DualPort<6>& site, const Rotation& T_ba = {},
          SourceLine at = std::source_location::current());

/// Fixes line `a` to line `b` along their whole length: `mount` of the bodies at their middles if a
/// is its body's parent (or b is), else `weld`, and equal motion and opposite forces of every
/// shape. T_ba: components in frame a to those in frame b; numbers, no parameter. Panels in one
/// plane share deflection and slope of the edge. Panels at an angle along it, as of a box, share
/// its slope, and the edge stays straight: the deflection of one panel is a motion of the other in
/// its plane, in which a plate is rigid. Membranes share all displacements, at any angle; a
/// membrane and a plate that is rigid in its plane meet at right angles or in one plane.
///
/// The meshes of the edges need not match if m is at most 4: the nodes' cubic functions then
/// contain the polynomials, both edges move, or are measured, by the same ones, and the scene is
/// stiffer than the edges welded point by point if both lines are `fe::shapes`, softer if both are
/// `fe::moments`; more polynomials bring them together. Polynomials of higher degree are
/// interpolated by the nodes of each edge, which must be equal ones then: between 4 and 7 elements
/// those of degree 4 differ by 0.017, between 6 and 16 those of degree 6 by 0.10.
///
/// Throws size for lines with other shapes, bad_value for lengths that differ by more than 1e-6,
/// two parents, axes that T_ba does not turn into each other, and a T_ba with parameters; `compile`
/// reports the errors of mount and weld.
void weld(const LinePort& a, const LinePort& b, const Rotation& T_ba = {},
          SourceLine at = std::source_location::current());

/// A hinge along the whole line, as between solar panels: `a`, which must be its body's parent,
/// turns about the line against `b`. As `weld`, but for the rotation about the line: as a rigid
/// motion it is the hinge's angle, and its shapes are released on both sides.
///
///     auto h = hinge_line(d, "h1", p2.line("inner"), p1.line("outer"));
///     h.torque = 20 * h.angle + 0.1 * h.rate;
Hinge::Handle hinge_line(Diagram& d, const std::string& name, const LinePort& a, const LinePort& b,
                         const Rotation& T_ba = {},
                         SourceLine at = std::source_location::current());

}  // namespace titop
