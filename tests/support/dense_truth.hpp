#pragma once

#include <complex>
#include <titop/graph/graph.hpp>

namespace titop_test {

/// Transfer of a diagram: all its equations at once in 100 digits, (s - A) x = B u and y = C x + D
/// u of every block and the user's equations, by Gaussian elimination with row pivoting of one
/// dense matrix. It shares no code with the compiler, only the graph and the blocks' data.
/// O(signals^3): for graphs of up to some hundred scalar signals.
struct DenseTruth {
  Eigen::MatrixXcd transfer;  ///< outputs x inputs, in the graph's order; rounded once
  /// Sums of magnitudes of the entries' terms: |E^-1| |E| |z| of E z = F, in double. Rounding every
  /// entry of the equations once changes the transfer by at most 1.2e-16 of it (times 2 and a
  /// little more).
  Eigen::MatrixXd terms;
};

/// At s, no 0 if positions or rates are read. Throws runtime_error if the equations are not as
/// many as the unknowns, or do not determine them: a pole.
DenseTruth dense_truth(const titop::Graph& graph, std::complex<double> s);

}  // namespace titop_test
