#pragma once

#include <Eigen/Core>
#include <titop/graph/graph.hpp>
#include <vector>

/// Inputs that are forces, with the outputs that are the accelerations where they act. For the
/// compiler's own files.
namespace titop::passes {

/// Both are in the declared order, scalar by scalar: row out[k] of a transfer is the motion along
/// which the force of column in[k] works.
struct DualPairs {
  int count = 0;             ///< inputs with such an output
  std::vector<int> in, out;  ///< columns and rows of a transfer
  std::vector<int> sizes;    ///< of the blocks that share a unit: threes, or single scalars
  static constexpr const char* kNone =
      "no output is the acceleration where an input acts as a force";
};

/// The pairs of the diagram as written: an input that acts on channels only, and the first output
/// that reads the motions of the same ones with the same weights. O(inputs * outputs).
DualPairs dual_pairs(const Graph& graph, ParameterValues values);

}  // namespace titop::passes
