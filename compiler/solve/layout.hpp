#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::detail {

/// Origin of the rows and columns of the model.
struct Layout {
  std::vector<int> state_nodes;   ///< nodes with states, as memory has them: in the graph's order
  std::vector<int> state_first;   ///< per node: first row of x, -1 for none
  std::vector<int> input_first;   ///< per graph input: first column of u
  std::vector<int> output_first;  ///< per graph output: first row of y
  std::vector<int> known_first;   ///< per signal: first row of [x; u], -1 for unknowns
  std::vector<std::string> states, inputs, outputs;  ///< states: of all blocks

  /// Number of states of all blocks, before dependent ones are eliminated (StateMap).
  Eigen::Index order() const { return static_cast<Eigen::Index>(states.size()); }
};

Layout make_layout(const Graph& graph);

/// Per state of all blocks its rate, -1 for none: as blocks declare it (Interface::rates). The
/// state of a one-way block may integrate a state of another: by its row of A (n x n, of all
/// blocks' states). O(n), and per state of a one-way block.
std::vector<int> rates_of(const Graph& graph, const Layout& layout, const Eigen::MatrixXd& A);

}  // namespace titop::detail
