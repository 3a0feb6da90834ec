#pragma once

#include <complex>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

/// The points s at which a system is evaluated for checks.
namespace titop::detail {

/// About the largest frequency of a block [rad/s], by its matrix A (n x n): independent of the
/// units of its states, and in units of 1 / time. 0 if A does not determine it. O(n^2) as a rule.
double frequency_of(const Eigen::MatrixXd& A);

/// Frequencies of an assembly by its written A, in which rigid bodies between springs have no
/// frequency as blocks: the mean (in its logarithm) over the states and the largest, each of a
/// state by the product of two entries. Empty if A does not determine them. O(n^2).
std::vector<double> frequencies_of(const Eigen::MatrixXd& A);

/// An s of about this modulus, so far off the axis that no pole is near.
std::complex<double> off_axis(double omega);

/// A frequency inside the blocks' own range, off the axis. O(bodies).
std::complex<double> pick_s(const Factored& data);

}  // namespace titop::detail
