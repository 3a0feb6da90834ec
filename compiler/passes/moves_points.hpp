#pragma once

#include <titop/graph/block.hpp>

namespace titop::passes {

/// True if the points of the block move in another way at the second values, since lengths, angles
/// or mode shapes differ; false of a block without kinematics.
inline bool moves_points(const Block& block, ParameterValues before, ParameterValues now) {
  const auto a = block.kinematics(before), b = block.kinematics(now);
  return a && (a->tau != b->tau || a->Phi != b->Phi);
}

}  // namespace titop::passes
