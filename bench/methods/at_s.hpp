#pragma once

#include <Eigen/Core>
#include <complex>

#include "support/network.hpp"

/// What one writes when nothing but the blocks' responses H(s) is at hand, y = H u, u = K y + E w,
/// in any precision (blocks included; their data are doubles). All throw runtime_error where a
/// pivot is missing.
namespace titop_bench {

enum class Digits { single, standard, extended, fifty };  ///< float, double, long double, 50 digits

/// I - K H as one dense matrix, partial pivoting. O(inputs of all blocks^3).
Eigen::MatrixXcd dense_at_s(const Network& network, std::complex<double> s,
                            Digits digits = Digits::standard);

/// In double with one step of iterative refinement, its residual in double.
Eigen::MatrixXcd refined_at_s(const Network& network, std::complex<double> s);

/// A bad example: the same eliminated block by block in order of declaration, each by its own
/// inverse; no pivot is ever sought in another block.
Eigen::MatrixXcd block_by_block_at_s(const Network& network, std::complex<double> s,
                                     Digits digits = Digits::standard);

/// A bad example: tearing, which on a chain is chain (transfer) matrices: what enters the first
/// block from the second is guessed, everything else follows block after block, and at the end the
/// guess is found from what the last block wants. For chains only: throws logic_error where a block
/// hears of others than its neighbours. O(blocks).
Eigen::MatrixXcd tearing_at_s(const Network& network, std::complex<double> s,
                              Digits digits = Digits::standard);

/// Whether tearing_at_s takes this network.
bool is_chain(const Network& network);

}  // namespace titop_bench
