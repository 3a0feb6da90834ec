#pragma once

#include <titop/analysis/lft/lft.hpp>

/// The opened model of a system, in matrices. For the folder's own files.
namespace titop::detail {

struct IsolatedParameter {
  int index = -1;  ///< among those of the diagram
  ParameterMap map;
};

/// Index of the parameter and whether it is an angle; notes mistakes.
IsolatedParameter unranged(const System& system, const std::string& name,
                           std::vector<Mistake>& mistakes);

/// The parameters of these ranges. Throws as `lft` does, all mistakes together.
std::vector<IsolatedParameter> isolated(const System& system, const ParameterRanges& ranges);

/// Inputs and outputs of the opened graph, in the order of their scalars in `in` and `out`.
struct OpenedPorts {
  std::vector<int> inputs, outputs;
};

/// The opened model before `minimize`, inputs [w; u] and outputs [z; y], w in the order of
/// `parameters`.
struct OpenedMatrices {
  StateSpace m;
  std::vector<Eigen::Index> in, out;            ///< places of its signals in the opened system
  std::vector<int> sizes;                       ///< pairs of each parameter
  std::vector<std::vector<std::string>> where;  ///< blocks and equations with it
  std::vector<OpenedPorts> ports;               ///< of each parameter, then those of u and y
};
OpenedMatrices opened_matrices(const System& opened,
                               const std::vector<IsolatedParameter>& parameters);

}  // namespace titop::detail
