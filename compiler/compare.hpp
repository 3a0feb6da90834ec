#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/graph/graph.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::detail {

/// How two transfers are compared. Three translations (or rotations) of one port share their unit:
/// such blocks of 3 x 3, and scalars by themselves, have one size.
struct Measure {
  std::vector<int> rows, cols;  ///< of the blocks, in the order of outputs and of inputs
  Eigen::MatrixXd terms = {};   ///< outputs x inputs, see `terms`; empty: not known
};

/// Blocks of a graph's outputs and inputs, as declared: threes where three divides a signal's size.
Measure measure(const Graph& graph, Eigen::MatrixXd terms);

/// What the entries of m's transfer are the sums of, before anything cancels: with the responses
/// X = (s I - A)^-1 B and W = C (s I - A)^-1, which make G = D + W (s I - A) X, the largest
/// |D| + |W| |s I - A| |X| at these points. In any units of states, inputs and outputs.
/// O(points n^3).
Eigen::MatrixXd terms(const StateSpace& m, const std::vector<std::complex<double>>& points);

/// Where two transfers differ most.
struct Difference {
  double relative = 0;
  std::size_t point = 0;  ///< index
};

/// Two transfers at the same points: each entry's difference over the size of its block. That is
/// the largest of: the largest value that the block takes in `exact`; 1e-5 of its terms, which may
/// cancel to nothing, as by symmetry (in double nothing is right to better than 1e-15 of its
/// terms); and 1e-3 of what its row and column come to, where the terms themselves are but rounding
/// (rows and columns below 1e-12 of all count as large as the largest). Not finite is infinitely
/// far.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, const Measure& measure);

}  // namespace titop::detail
