#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/graph/graph.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::detail {

using linalg::kNoise;

/// Least size of an entry, relative to its terms: if they cancel further, double has no better
/// accuracy than 1e-15 of them. The size of an entry that is 0 to the last bit is taken relative to
/// its neighbours, since its terms may cancel to 1e-17 in another order of summation.
inline constexpr double kLeastSize = 1e-3;
/// Six digits. An entry whose terms exceed this share of their neighbours has lost digits by
/// rounding; below it the entry may be a 0 that double misses. An entry is certain if two
/// computations agree to this. A larger error of an output far below its peak is reported.
inline constexpr double kSixDigits = 1e-6;

/// Scales for the comparison of two transfers. Three translations (or rotations) of one port share
/// their unit: such blocks of 3 x 3, and single scalars, have one size.
struct Measure {
  std::vector<int> rows, cols;  ///< of the blocks, in the order of outputs and of inputs
  Eigen::MatrixXd terms = {};   ///< outputs x inputs, see `terms`; empty: not known
};

/// Blocks of a graph's outputs and inputs, as declared: threes if three divides a signal's size.
Measure measure(const Graph& graph, Eigen::MatrixXd terms);

/// The model's transfers at these points, by StateSpace::transfer. A pair without a path through
/// nonzero entries of A, B, C and D is exactly 0, without the rounding of row operations. Throws
/// singular at a pole. O(points n^3).
std::vector<Eigen::MatrixXcd> transfers(const StateSpace& m,
                                        const std::vector<std::complex<double>>& points);

/// The same to the last places of double (linalg::refined_response), without the rounding of an
/// evaluation in double. The same bits for any order of the states.
std::vector<Eigen::MatrixXcd> refined_transfers(const StateSpace& m,
                                                const std::vector<std::complex<double>>& points);

/// Size of the terms whose sums are the entries of m's transfer, before cancellation: with the
/// responses X = (s I - A)^-1 B and W = C (s I - A)^-1, which make G = D + W (s I - A) X, the
/// largest |D| + |W| |s I - A| |X| at these points. Independent of the units of states, inputs and
/// outputs. O(points n^3).
Eigen::MatrixXd terms(const StateSpace& m, const std::vector<std::complex<double>>& points);

/// These terms where an entry may be a 0: their rounding is below 1e-6 of the geometric mean of the
/// largest entries in row and column of `exact`, or that is 0. Elsewhere 0: with more rounding the
/// model has lost digits everywhere, and an entry is no 0 compared with others.
Eigen::MatrixXd of_nothing(const Eigen::MatrixXd& terms,
                           const std::vector<Eigen::MatrixXcd>& exact);

/// As `terms`, for the rounding of the model's own A, B, C and D (matrices of their sizes): |dD| +
/// |W| |dB| + |dC| |X| + |W| |dA| |X| over the rounding unit. These are sums of magnitudes, without
/// a statistical margin. 0 as in `of_nothing`, relative to the model's own transfers. O(points
/// n^3).
Eigen::MatrixXd terms_of_rounding(const StateSpace& m, const StateSpace& rounding,
                                  const std::vector<std::complex<double>>& points);

/// Factor on one sample of rounding, taken after a step of refinement, as a bound for many.
inline constexpr double kTermsPerRounding = 100 / linalg::kEpsilon;

/// The same of `transfer(graph, s, values)` (compiler/definition/transfer.hpp): all equations
/// against all in reverse order, likewise. Outputs and inputs in the graph's order. O(points
/// signals^3).
Eigen::MatrixXd terms(const Graph& graph, const std::vector<std::complex<double>>& points,
                      ParameterValues values);

/// Adds the terms of an elimination to the measure, for blocks of `exact` that may be rounding
/// alone: below 1e3 of one sample of it, where three digits or fewer remain. A larger block is
/// compared with its own size, even if double has lost many digits. If `exact` is 0 to the last bit
/// (possible with rotated frames), there is no sample: 1e-3 of the geometric mean of the entries in
/// its row and column is used as terms, so that `difference` is 1 at 1e-6 of that.
void add_rounding(Measure& measure, const std::vector<Eigen::MatrixXcd>& exact,
                  const Eigen::MatrixXd& terms);

/// Up to 8 of these points, spread over all of them, the last one included.
std::vector<std::complex<double>> some_of(const std::vector<std::complex<double>>& points);

/// Place of the largest difference of two transfers.
struct Difference {
  double relative = 0;
  std::size_t point = 0;  ///< index
};

/// A smaller change of a transfer, of each entry, is none: a simpler model with it may replace the
/// other.
inline constexpr double kUnchanged = 1e-8;

/// Two transfers at the same points: each entry's difference over the size of its block. That is
/// the largest value of the block in `exact`, or 1e-3 of its terms if these are larger and cancel,
/// as by symmetry (double has no better accuracy than 1e-15 of the terms, and the entries of a
/// dense model have lost some digits when they were made). No block is measured by its neighbours
/// (except a 0 to the last bit, by add_rounding): the result is independent of the units of scalars
/// and of vectors of three, whose components share a unit. Infinite for values that are not finite,
/// and for a difference where `exact` and the terms are 0.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, const Measure& measure);

}  // namespace titop::detail
