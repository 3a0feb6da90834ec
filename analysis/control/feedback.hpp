#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

/// Loops of state-space models, closed in matrices. For the folder's own files.
namespace titop::detail {

/// The loop transfer L (n x n) with u_j = d_j - y_j in the loops `closed`, y_j its outputs: the
/// same inputs (d_j of the closed ones) and outputs. Throws ill_posed if 1 + D is singular there.
/// O(n^2 loops).
StateSpace with_closed(const StateSpace& L, const std::vector<int>& closed);

/// S = (1 + L)^-1. Throws as `with_closed`.
StateSpace sensitivity(const StateSpace& L);

/// L of loop i alone, all others closed: 1 x 1.
StateSpace alone(const StateSpace& L, int i);

}  // namespace titop::detail
