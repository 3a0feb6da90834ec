#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/compiler/compare.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

/// Inputs that are forces, with the outputs that are the accelerations where they act. For the
/// compiler's own files.
namespace titop::full {

/// True if a channel's force acts from its block on its surroundings: at a parent point and about
/// the axis of a joint. At a child point, also of a bushing, it acts on the block.
bool is_outward(const ChannelSpec& channel);
bool is_outward(const Graph& graph, int channel);

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

/// The transfers between them, at some points.
struct DualTransfers {
  std::vector<std::complex<double>> points;
  std::vector<Eigen::MatrixXcd> G;  ///< forces x forces
  detail::Measure by;               ///< the same blocks of rows and of columns

  /// Possible rounding of a 0 in this block of rows and columns; 0 if it is not known.
  double floor(Eigen::Index row, Eigen::Index column, Eigen::Index rows,
               Eigen::Index columns) const;
};

/// Selects them from transfers in the declared order.
DualTransfers dual_transfers(const DualPairs& pairs,
                             const std::vector<std::complex<double>>& points,
                             const std::vector<Eigen::MatrixXcd>& transfers);

/// The same with a floor for blocks at rounding level: by transfers in double and
/// in long double at all points. Slow.
DualTransfers with_rounding(const System& system, const DualPairs& pairs, DualTransfers transfers);

}  // namespace titop::full
