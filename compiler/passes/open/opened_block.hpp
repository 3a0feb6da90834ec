#pragma once

#include <titop/graph/block.hpp>
#include <vector>

namespace titop::passes {

/// Ports of an opened block for the pairs of one parameter, "w NAME" and "z NAME".
struct ParameterPorts {
  int parameter = -1;
  int size = 0;
};

/// Block::opened as a block of its own: the ports of `block`, then a one-way port per parameter.
/// `opened`: the result for some values, which determines the sizes of the ports.
BlockPtr opened_block(BlockPtr block, const std::vector<ParameterPorts>& ports, bool differences);

/// The ports that this block has with these parameters opened, in the order of `parameters`; those
/// without pairs are left out. Empty if the block cannot be opened. `differences`: also by
/// differences of its matrices (opened_to_first_order).
std::vector<ParameterPorts> opened_ports(const Block& block, ParameterValues values,
                                         std::span<const int> parameters, bool differences);

}  // namespace titop::passes
