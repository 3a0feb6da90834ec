#pragma once

#include <Eigen/Core>
#include <complex>
#include <limits>
#include <titop/graph/graph.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {
class System;
}

namespace titop::detail {

/// Times rounding: what is below may be nothing else.
inline constexpr double kNoise = 1e3;
/// Of an entry's neighbours: the terms of a 0 that one order of sums hits exactly and another to
/// 1e-17.
inline constexpr double kHitBy = 1e-3;

/// How two transfers are compared. Three translations (or rotations) of one port share their unit:
/// such blocks of 3 x 3, and scalars by themselves, have one size.
struct Measure {
  std::vector<int> rows, cols;  ///< of the blocks, in the order of outputs and of inputs
  Eigen::MatrixXd terms = {};   ///< outputs x inputs, see `terms`; empty: not known
};

/// Blocks of a graph's outputs and inputs, as declared: threes where three divides a signal's size.
Measure measure(const Graph& graph, Eigen::MatrixXd terms);

/// The model's transfers at these points. A pair without a path through nonzero entries of A, B, C
/// and D is 0 in them, and not what row operations leave of it. O(points n^3).
std::vector<Eigen::MatrixXcd> transfers(const StateSpace& m,
                                        const std::vector<std::complex<double>>& points);

/// What the entries of m's transfer are the sums of, before anything cancels: with the responses
/// X = (s I - A)^-1 B and W = C (s I - A)^-1, which make G = D + W (s I - A) X, the largest
/// |D| + |W| |s I - A| |X| at these points. In any units of states, inputs and outputs.
/// O(points n^3).
Eigen::MatrixXd terms(const StateSpace& m, const std::vector<std::complex<double>>& points);

/// Of these terms, those whose rounding is below 1e-6 of what stands in the row and column of
/// `exact` (their geometric mean), and all where nothing stands there; else 0. What rounds more is
/// no 0 beside others: such a model has lost digits everywhere, and an entry of it may be anything.
Eigen::MatrixXd of_nothing(const Eigen::MatrixXd& terms,
                           const std::vector<Eigen::MatrixXcd>& exact);

/// The same as `terms` of the model's own rounding, what it may have put into each entry of A, B, C
/// and D (matrices of their sizes): |dD| + |W| |dB| + |dC| |X| + |W| |dA| |X| over the rounding
/// unit. These are sums of magnitudes: no luck has to be allowed for. 0 as in `of_nothing`, beside
/// the model's own transfers. O(points n^3).
Eigen::MatrixXd terms_of_rounding(const StateSpace& m, const StateSpace& rounding,
                                  const std::vector<std::complex<double>>& points);

/// What one rounding stands for: it is one sample, after a step of refinement, of what many may do.
inline constexpr double kTermsPerRounding = 100 / std::numeric_limits<double>::epsilon();

/// The same of what cancels inside the elimination, seen by its rounding: kTermsPerRounding times
/// double against long double at these points. Slow.
Eigen::MatrixXd terms(const System& system, const std::vector<std::complex<double>>& points);

/// The same of `transfer(graph, s, values)` (compiler/transfer.hpp): all equations against all in
/// reverse order, likewise. Outputs and inputs in the graph's order. O(points signals^3).
Eigen::MatrixXd terms(const Graph& graph, const std::vector<std::complex<double>>& points,
                      ParameterValues values);

/// Adds the terms of an elimination to the measure, for blocks of `exact` that may be nothing but
/// its rounding: below 1e3 of one sample of it, where three digits or fewer are left. A block that
/// stands out is measured by itself, however many digits double has lost. Where `exact` is 0 to the
/// last bit, as turned frames may leave it, there is no sample: 1e-3 of the geometric mean of what
/// stands in its row and column counts as terms, so that `difference` has 1 at 1e-6 of that.
void add_rounding(Measure& measure, const std::vector<Eigen::MatrixXcd>& exact,
                  const Eigen::MatrixXd& terms);

/// Up to 8 of these points, spread over all of them, the last one included.
std::vector<std::complex<double>> some_of(const std::vector<std::complex<double>>& points);

/// Where two transfers differ most.
struct Difference {
  double relative = 0;
  std::size_t point = 0;  ///< index
};

/// Above it a difference may be rounding of terms that a dense model does not show.
inline constexpr double kClose = 1e-9;

/// Two transfers at the same points: each entry's difference over the size of its block. That is
/// the largest value that the block takes in `exact`, or 1e-3 of its terms where these are larger
/// and cancel, as by symmetry (in double nothing is right to better than 1e-15 of its terms, and
/// the entries of a dense model have lost some digits where they were made). No block is measured
/// by its neighbours (but a 0 to the last bit, by add_rounding): the result is the same in all
/// units of scalars and of whole threes; what stands in one three is taken to share a unit. Not
/// finite, or a difference where `exact` and the terms are 0, is infinitely far.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, const Measure& measure);

/// The same for an `exact` that is the system's own at these points. Where that is above kClose,
/// the terms of the elimination, at up to 8 of the points, join the measure first.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, Measure& measure,
                      const System& system, const std::vector<std::complex<double>>& points);

}  // namespace titop::detail
