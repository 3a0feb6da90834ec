#pragma once

#include <initializer_list>
#include <string>
#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/diagram.hpp>
#include <vector>

namespace titop {

/// A row of a table of damping ratios.
struct DampingPoint {
  double hertz;  ///< frequency of an assembled mode [Hz]
  double xi;     ///< its damping ratio [-]
  DampingPoint(double frequency, double ratio) : hertz(frequency), xi(ratio) {}
};

/// Damping ratios of assembled modes: one number, or a table over their undamped frequencies.
class ModalDamping {
 public:
  /// xi of all modes [-]. Throws bad_value unless 0 <= xi < 1.
  ModalDamping(double xi);
  /// Linear in the frequency between two rows, constant below the first and above the last. Throws
  /// bad_value for an empty table, frequencies that are negative or do not increase, and xi as
  /// above.
  ModalDamping(std::vector<DampingPoint> table);
  /// ModalDamping{{1.0, 0.003}, {10.0, 0.005}}
  ModalDamping(std::initializer_list<DampingPoint> table)
      : ModalDamping(std::vector<DampingPoint>(table)) {}

  /// The damping ratio of a mode at omega [rad/s].
  double at(double omega) const;

 private:
  std::vector<DampingPoint> table_;
};

/// Boundary of the part's root for the modes whose damping is prescribed.
enum class RootBoundary {
  clamped,  ///< on a rigid bench, as appendages are tested
  free      ///< without supports, as a spacecraft in orbit
};

/// A port of the part that becomes a child of the body, as {"C", "tip.C1"}.
struct AssemblyPort {
  std::string name;  ///< of the child
  std::string port;  ///< "node.port" in the part
};

/// A body made of a part of the scene, with modal damping of its ASSEMBLED modes, as test reports
/// state it: the part's M, K and ports, and with its undamped modes Phi (mass-normalised, of
/// frequencies w, the root clamped or free)
///
///     D = M Phi diag(2 xi w) Phi' M
///
/// so that each of these modes has exactly its xi; rigid motion is undamped [Craig and Kurdila
/// 2006, 10.3]. D replaces all damping of the part, that of its bodies' modes and of its joints. (A
/// body with a loss factor is refused, not_rational: give FlexibleBody{body.data()} to the part.)
///
///     Diagram part{"wing"};
///     auto boom = part.add("boom", FlexibleBody{data});                  // 0.3 %: ignored here
///     auto tip = part.add("tip", RigidBody{.mass = 12, .children = {{"C1", {0, 0, 0.1}}}});
///     mount(tip, boom.child("C"), T_bt);
///     auto wing = d.add("wing",
///                       damping_of_assembly(part, "boom.parent", {{"C", "tip.C1"}}, 0.003));
///     mount(wing, hub.child("W"), T_hw);
///
/// `part`: bodies, joints on springs and closed chains, without inputs and outputs; parameters at
/// their nominal values. `root`: the parent port of a body, driven by nothing, where the part
/// hangs. `ports`: child ports of six degrees of freedom. `clamped`: the body's modes are those of
/// the part clamped at the root, each with its xi (FlexibleBody::data). `free`: the same modes, and
/// a damping matrix that couples them (FlexibleBody::damping). The body's frame is that of the
/// root; child ports have it, too, so that wrenches and mounting rotations at the children are in
/// the frame of the root.
///
/// Throws, with the names of the ports and states: unknown_name (with the valid names), bad_value
/// (a root that is driven or is no parent port, a port without six degrees of freedom; inputs or
/// outputs; motions without stiffness; controllers, momenta, dampers without a spring: no symmetric
/// second-order form; a part that is not passive), duplicate_name, not_rational (distributed beams,
/// ExactBeam), the errors of `compile` and of `FlexibleBody`: bad_inertia where the mass of a part
/// is not that of a rigid body (a SpringMass has mass along its axis only: put it on the body for
/// the others). Cost: that of `compile`, and O(n^3) for n modes.
FlexibleBody damping_of_assembly(const Diagram& part, const std::string& root,
                                 const std::vector<AssemblyPort>& ports, const ModalDamping& xi,
                                 RootBoundary boundary = RootBoundary::clamped,
                                 SourceLine at = std::source_location::current());

}  // namespace titop
