#pragma once

#include <titop/compiler/definition/exact/coefficients.hpp>
#include <titop/compiler/definition/exact/equations.hpp>

/// Solutions without rounding. For the library's own files.
namespace titop::exact {

/// X of E X = F, E square. Throws Undecided if E is singular. O(n^3).
ExactMatrix solved(const ExactMatrix& E, const ExactMatrix& F);

/// C (s - A)^-1 B + D at one number s. Throws Undecided if s is a pole. O(states^3).
ExactMatrix transfer_of(const Model& model, const Residue& s);

/// Rank of a dense matrix. O(n^3).
int rank_of(const ExactMatrix& m);

}  // namespace titop::exact
