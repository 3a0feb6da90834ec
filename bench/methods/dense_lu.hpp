#pragma once

#include <titop/graph/state_space.hpp>

#include "support/network.hpp"

namespace titop_bench {

/// The network as one dense model: A + B K (I - D K)^-1 C and so on by Eigen's PartialPivLU of
/// I - D K; products with K, B and F are sparse. O(outputs^3).
void dense_lu(const Network& network, titop::StateSpace& model);

}  // namespace titop_bench
