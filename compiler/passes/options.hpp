#pragma once

#include <string>

namespace titop {

/// Internal forces of over-constrained closed chains, which motion does not determine.
enum class InternalForces {
  refuse,        ///< outputs and controllers that read one are refused by name
  minimal_norm,  ///< the joint that closes the chain gets the wrench of smallest norm, forces [N]
                 ///< and torques [N m] with equal weight; the log lists its readers
};

/// Options of `compile`.
struct Options {
  /// Up to this many states, `state_space()` also removes states without effect on the transfer
  /// (pass `minimize`, O(n^3)); beyond it only those that the structure shows. 0: never.
  int minimize_up_to = 100;
  /// Folder for Graphviz files of the diagram as written (00-diagram.dot) and after each graph
  /// pass (01-check.dot, 02-lower.dot, ...); empty: none.
  std::string dump_to = {};
  /// Relative tolerance (half-bandwidth, below 1) of the minimal realization; 0: rounding level
  /// only.
  double resolution = 0;
  InternalForces internal_forces = InternalForces::refuse;
  /// Up to this many states the minimal order of the diagram's numbers as they are given, to the
  /// last bit, decides which states `minimize` removes, if exact arithmetic can count it
  /// (compiler/definition/exact_order.hpp); `minimize` runs up to the same number of states unless
  /// minimize_up_to is 0. 0: exact arithmetic only lowers an order, in small diagrams
  /// (OrderVerdict).
  int exact_up_to = 0;
};

}  // namespace titop
