#pragma once

#include <optional>
#include <string>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::minreal {

/// A model of a given order, and notes on the states that left.
struct ModelOfOrder {
  StateSpace model;
  std::vector<std::string> notes;
  double tolerance = 0;  ///< parts of A, B, C, relative to their sizes, that were taken for 0
};

/// The reachable and observable part of a model whose minimal order is known, by the least
/// tolerance of a rank, among powers of ten from 1e-16 to 1e-6, that leads to this order; none if
/// no tolerance does. Orthonormal bases of the spans of [B, A B, ...] and [C; C A; ...]' in the
/// states' own sizes [Arnoldi 1951, in blocks]; the remaining states keep name and meaning. By
/// name, so that the last bits do not depend on the order of the states. The transfer is not
/// compared. O(n^3) per tolerance.
std::optional<ModelOfOrder> to_order(const StateSpace& model, int order);

}  // namespace titop::minreal
