#pragma once

#include <string>
#include <titop/graph/graph.hpp>
#include <titop/graph/state_space.hpp>

namespace titop {

/// The order of a transfer in arithmetic without rounding, or the reason why it is not decided.
struct ExactOrder {
  bool decided = false;
  int order = 0;       ///< the minimal order of the transfer
  int reachable = 0;   ///< dimension of the reachable subspace
  int observable = 0;  ///< rank of the observability matrix
  int states = 0;      ///< of the equations that were used
  std::string why_not;
};

/// Rotations in exact arithmetic.
enum class ExactRotations {
  fractions,  ///< entries that are fractions of small denominators; others are refused by name
  nearest,    ///< else the exact rotation of the rounded quaternion, within rounding of the matrix
};

/// Limits of `exact_order`.
struct ExactOptions {
  int states = 200;     ///< larger problems are refused: the cost is that of `exact_order`
  int unknowns = 4000;  ///< scalar port signals and states of a diagram: likewise
  ExactRotations rotations = ExactRotations::fractions;
};

/// Minimal order of the graph's equations (those that `transfer(graph, s)` solves) without
/// rounding: ranks of [B, A B, ...], [C; C A; ...] and of their product, by elimination modulo two
/// primes of 60 bits, as every double is a fraction. A number other than 0 is taken for 0, and a
/// rank is then too low, with a probability below 1e-22 (compiler/definition/exact/residue.hpp).
///
/// Exact for the entries of the blocks' matrices as doubles (of a body with modes, its modes and
/// frequencies): k / m has been rounded if m is no power of two (equal ratios stay equal). A
/// rotation counts as exact if its entries are fractions of denominators up to 1000 (0.6 is 3/5)
/// and these are orthonormal; parts (.along) likewise; the entries of other matrices are taken as
/// exact. Another rotation is refused by name: with rounded cosines a redundant constraint becomes
/// an independent one. Not decided either: a diagram without inputs or without outputs; equations
/// that do not determine the outputs without derivatives; more states or unknowns than the options
/// allow. Throws the mistakes noted in the graph, not_rational for blocks with infinitely many
/// modes (ClosedForm), and the errors of blocks for bad values, no others. Cost: 3 ms for a spatial
/// diagram of 28 states and 400 signals, 0.3 s for 200 states that are all coupled, O(states^3).
ExactOrder exact_order(const Graph& graph, const ExactOptions& options = {},
                       ParameterValues values = {});

/// The same from the entries of A, B, C, taken as exact.
ExactOrder exact_order(const StateSpace& model, const ExactOptions& options = {});

/// "exact: order 8 (of 10 states, 8 reachable, 8 observable)", or "not decided exactly: ...".
std::string to_string(const ExactOrder& result);

}  // namespace titop
