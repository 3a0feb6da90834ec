#pragma once

#include <string>
#include <titop/blocks/axis.hpp>
#include <titop/graph/block.hpp>
#include <vector>

/// Common to hinge, slide and joints of several axes: one massless block.
namespace titop {

/// The user's names of the ports of one axis.
struct AxisNames {
  std::string channel, force;  ///< "" and "torque": h.torque; "azimuth" and "force"
  std::string position, rate;  ///< readings, and names of the states
};

/// Massless joint that leaves free the motions S = [s1 ... sk] (6 x k), s the twists of the axes:
///
///     xdd_C = xdd_P + S qdd,   F_P = F_C,   Q = S' F_C
///
/// u = [F_C; xdd_P; qdd], y = [xdd_C; F_P; Q; q; qd]; states q, then qd. `carries`: the property
/// that the carried body needs if Q is imposed, "inertia about its axis". Throws bad_value for an
/// axis without direction, for one that depends on the axes before it, and for no axis;
/// duplicate_name.
BlockPtr joint_block(std::string_view type, const std::vector<Axis>& axes,
                     const std::vector<AxisNames>& names, std::string carries);

}  // namespace titop
