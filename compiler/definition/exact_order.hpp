#pragma once

#include <string>
#include <titop/graph/graph.hpp>
#include <titop/graph/state_space.hpp>

namespace titop {

/// The order of a transfer in exact arithmetic, or the reason why it is not decided.
struct ExactOrder {
  bool decided = false;
  int order = 0;       ///< the minimal order of the transfer
  int reachable = 0;   ///< dimension of the reachable subspace
  int observable = 0;  ///< rank of the observability matrix
  int states = 0;      ///< of the equations that were used
  std::string why_not;
};

struct ExactOptions {
  int states = 40;      ///< larger problems are refused: the cost is that of `exact_order`
  int unknowns = 2000;  ///< scalar port signals and states of a diagram: likewise
  int bits = 200'000;   ///< refused if integers get longer; this limits the time
};

/// Minimal order of the graph's equations (those that `transfer(graph, s)` solves), in integers of
/// any length: every double is a fraction whose denominator is a power of two. Ranks of [B, A B,
/// ...], [C; C A; ...] and of their product, by elimination without division.
///
/// Exact for the entries of the blocks' matrices as doubles (of a body with modes, its modes and
/// frequencies): k / m has been rounded if m is no power of two (equal ratios stay equal). A
/// rotation counts as exact if its entries are fractions of denominators up to 1000 (0.6 is 3/5)
/// and these are orthonormal; parts (.along) likewise; the entries of other matrices are taken as
/// exact. Another rotation is refused by name: with rounded cosines a redundant constraint becomes
/// an independent one. Not decided either: a diagram without inputs or without outputs; equations
/// that do not determine the outputs without derivatives; more states, unknowns or bits than the
/// options allow. Throws the mistakes noted in the graph and the errors of blocks for bad values,
/// no others. Cost: milliseconds for whole numbers, even with a hundred states. If n states are all
/// coupled by numbers of 53 bits, integers grow to about 80 n^2 bits and the time as n^7: 2 s for
/// 16 states, 7 s for 20, half a minute for 24, and (extrapolated) half an hour for 40. `bits` =
/// 20'000 refuses those of more than 16 such states, mostly within a minute.
ExactOrder exact_order(const Graph& graph, const ExactOptions& options = {},
                       ParameterValues values = {});

/// The same from the entries of A, B, C, taken as exact.
ExactOrder exact_order(const StateSpace& model, const ExactOptions& options = {});

/// "exact: order 8 (of 10 states, 8 reachable, 8 observable)", or "not decided exactly: ...".
std::string to_string(const ExactOrder& result);

}  // namespace titop
