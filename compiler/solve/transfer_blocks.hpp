#pragma once

#include <functional>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

/// Blocks of a transfer: a port by a port, dual vectors in halves, whose entries share a unit.
namespace titop::detail {

/// The parts that share a unit among the inputs or outputs of some ports.
struct PortGroups {
  std::vector<Eigen::Index> first = {0};  ///< place of each among those of these ports; the end
  std::vector<Eigen::Index> index;        ///< of each among those of all ports
  Eigen::Index size() const { return std::ssize(index); }
};

/// Of these inputs of the graph, in this order.
PortGroups groups_of_inputs(const Factored& data, const std::vector<int>& ports);
PortGroups groups_of_outputs(const Factored& data, const std::vector<int>& ports);
std::vector<int> all_inputs(const Factored& data);
std::vector<int> all_outputs(const Factored& data);

/// Largest entries of the blocks that these groups make.
Eigen::MatrixXd block_sizes(const Eigen::MatrixXcd& m, const PortGroups& rows,
                            const PortGroups& cols);

/// Geometric means of the largest entries in a block's row and column.
Eigen::MatrixXd beside_blocks(const Eigen::MatrixXd& size);

/// Whether a block is 0 with rounding.
enum class ZeroBlock {
  no,
  assumed,   ///< it may be: if its neighbours are 0, too, no digit is known
  confirmed  ///< by finer arithmetic (Factored::zero_blocks), also if its neighbours are 0
};

/// Largest change of a block relative to its largest entry; of one that is changed by more than
/// 1e-3 of that and is a 0, relative to its neighbours (RefinedSolution::refinement_error).
/// Infinite if a number is not finite.
double relative_change(const Eigen::MatrixXcd& of, const Eigen::MatrixXcd& change,
                       const PortGroups& rows, const PortGroups& cols,
                       const std::function<ZeroBlock(Eigen::Index, Eigen::Index)>& zero);

}  // namespace titop::detail
