#pragma once

#include <string>
#include <titop/compiler/system/system.hpp>
#include <vector>

namespace titop {

/// A control loop, cut at loop points of the diagram (Diagram::loop_point). Signs are those of
/// negative feedback: u is the signal fed into the diagram after the cut, and the diagram returns
/// -L u to the cut, so that the closed loop is 1 + L = 0. A law written as
/// `torque = K (wanted - angle)` has L = K G, with G from the torque to the angle; one that is
/// written with its sign elsewhere has the same L.
///
///     u --> [rest of the diagram] --> -L u        closed: u = -L u + d = S d,  L u = T d
///
/// A loop that feeds back with a plus (u = +L0 u) has L = -L0.
struct ControlLoop {
  std::vector<std::string> points;  ///< the names, in the order of rows and columns
  /// From u to the negative of the signal that returns to the cut. Its state-space model is
  /// minimized whatever Options::minimize_up_to is.
  System L;
  System S;  ///< from d added at the cut to u: (1 + L)^-1, the sensitivity
  System T;  ///< from d to L u: L (1 + L)^-1 = 1 - S, the complementary sensitivity
};

/// The loop at this loop point, at the system's present parameter values. Of a loop point of n
/// signals, L, S and T are n x n, from and to the names "attitude(1)", ... Inputs and outputs of
/// the diagram are left out (0), and with them the states that are unreachable or unobservable from
/// the loop point: its margins do not judge those. All other loop points stay closed. Cost: that of
/// three compiles.
///
/// Throws unknown_name with the system's loop points; the errors of `compile` for a diagram that
/// does not make sense without the loop (improper, ill_posed).
///
///     const ControlLoop attitude = loop(system, "attitude");
///     std::printf("%s", to_string(margins(attitude)).c_str());
ControlLoop loop(const System& system, const std::string& name);

/// The loop cut at several points at once, rows and columns in this order. Throws duplicate_name
/// for a name given twice, bad_value for none.
///
///     const ControlLoop both = mimo_loop(system, {"roll", "yaw"});
ControlLoop mimo_loop(const System& system, const std::vector<std::string>& names);

/// Names of the diagram's loop points, in the order of their declaration.
std::vector<std::string> loop_points(const System& system);

}  // namespace titop
