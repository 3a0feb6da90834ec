#pragma once

#include <titop/compiler/definition/exact/echelon.hpp>
#include <titop/compiler/definition/exact_order.hpp>

namespace titop::exact {

/// xdot = A x + B u, y = C x + D u. Inputs in the order of their signals, outputs in that of the
/// graph.
struct Model {
  int states = 0;
  Square A, A_transposed;
  std::vector<SparseRow> B;  ///< per input, over states
  std::vector<SparseRow> C;  ///< per output, over states
  std::vector<SparseRow> D;  ///< per output, over inputs; of a StateSpace: 0
};

/// From all equations of the graph; a position or a rate is a chain of integrators on
/// its acceleration. Throws Undecided.
Model model_of(const Graph& graph, const ExactOptions& options, ParameterValues values);

/// From the entries of the matrices, taken as exact.
Model model_of(const StateSpace& model);

}  // namespace titop::exact
