#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/compiler/index_reduction/watched.hpp>
#include <vector>

/// Motions that no equation determines: a massless strut between two pin joints rotates about its
/// own axis freely, and the sum of torques about that axis is 0 = 0. If no output or state depends
/// on such a motion it may be set to 0, in place of the equation without content.
namespace titop::detail {

/// direction * signal = 0 in place of a row.
struct HeldDirection {
  int row = -1;                  ///< scalar row of the joint system
  int signal = -1;               ///< an acceleration
  Eigen::RowVectorXd direction;  ///< of length 1, over translation or rotation alone
};

/// Treatment of rows without content.
struct Undetermined {
  std::vector<HeldDirection> held;  ///< one per row; none if a motion matters or there is none
  /// A line per motion, as "nothing determines the rotation of A.parent about x". In `held`: the
  /// motion set to 0; else: followed by the outputs or states that depend on it.
  std::vector<std::string> lines;
  StateMarks
      states;  ///< with `held`: states moved by such motions, undetermined and unread themselves
};

/// The motions of the singular joint system k.joint, from its factors d.factors with patches:
/// columns z with L z = 0 that move no state of any block and reach no output, to rounding (sums
/// are 0 below solve::kCancelled of their terms). `rows`: scalar rows, independent of one another,
/// that follow from the others, with their known sides. O(bodies) in time and memory per such
/// motion, their square in pairs.
Undetermined undetermined(const Skeleton& k, const Factored& d, const std::vector<int>& rows);

}  // namespace titop::detail
