#pragma once

#include <complex>
#include <titop/compiler/system/system.hpp>

namespace titop_bench {

/// Transfer of a compiled scene at s in 150 decimal digits, by dense elimination with partial
/// pivoting of all equations of all blocks: independent of the library's elimination. The data are
/// the blocks' doubles (in modal form if the block has one). O(inputs of all blocks^3): for small
/// scenes.
Eigen::MatrixXcd oracle_transfer(const titop::System& system, std::complex<double> s);

}  // namespace titop_bench
