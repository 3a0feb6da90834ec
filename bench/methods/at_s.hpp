#pragma once

#include <Eigen/Core>
#include <complex>

#include "support/network.hpp"

/// Methods that need only the blocks' responses H(s), y = H u, u = K y + E w, in any precision
/// (blocks included; their data are doubles). All throw runtime_error for a zero pivot.
namespace titop_bench {

enum class Digits { single, standard, extended, fifty };  ///< float, double, long double, 50 digits

/// I - K H as one dense matrix, partial pivoting. O(inputs of all blocks^3).
Eigen::MatrixXcd dense_at_s(const Network& network, std::complex<double> s,
                            Digits digits = Digits::standard);

/// In double with one step of iterative refinement, its residual in double.
Eigen::MatrixXcd refined_at_s(const Network& network, std::complex<double> s);

/// A poor method: the same, eliminated block by block in order of declaration, each by its own
/// inverse; pivots are never sought in another block.
Eigen::MatrixXcd block_by_block_at_s(const Network& network, std::complex<double> s,
                                     Digits digits = Digits::standard);

/// A poor method: tearing, on a chain the method of chain (transfer) matrices: the inputs of the
/// first block from the second are torn, all other signals follow block after block, and the last
/// block's equations determine the torn ones. For chains only: throws logic_error if a block is
/// coupled to others than its neighbours. O(blocks).
Eigen::MatrixXcd tearing_at_s(const Network& network, std::complex<double> s,
                              Digits digits = Digits::standard);

/// True if tearing_at_s applies to this network.
bool is_chain(const Network& network);

}  // namespace titop_bench
