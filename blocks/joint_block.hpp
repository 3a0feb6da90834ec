#pragma once

#include <string>
#include <titop/blocks/axis.hpp>
#include <titop/graph/block.hpp>
#include <vector>

/// What hinge, slide and joints of several axes share: one massless block.
namespace titop {

/// What the user calls the ports of one axis.
struct AxisNames {
  std::string channel, force;  ///< "" and "torque": h.torque; "azimuth" and "force"
  std::string position, rate;  ///< readings, and names of the states
};

/// Massless joint that leaves free the motions S = [s1 ... sk] (6 x k), s the twists of the axes:
///
///     xdd_C = xdd_P + S qdd,   F_P = F_C,   Q = S' F_C
///
/// u = [F_C; xdd_P; qdd], y = [xdd_C; F_P; Q; q; qd]; states q, then qd. `carries` is what the
/// carried body needs where Q is imposed: "inertia about its axis". Throws bad_value for an axis
/// without direction or one that the axes before it span already, and for none; duplicate_name.
BlockPtr joint_block(std::string_view type, const std::vector<Axis>& axes,
                     const std::vector<AxisNames>& names, std::string carries);

}  // namespace titop
