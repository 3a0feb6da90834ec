#pragma once

#include <titop/compiler/realization/writing.hpp>
#include <titop/graph/state_space.hpp>

/// The coefficients of targets, in numbers.
namespace titop::detail {

/// The coefficients of all targets' unknowns, at Target::coefficients and TargetTerm::to. `to`:
/// zeros. O(terms).
void find_coefficients(const Factored& data, const Writing& writing, double* to);

/// Adds the terms of all targets that no unknown carries: states and inputs times numbers.
/// O(terms).
void add_direct_terms(const Factored& data, const Writing& writing, StateSpace& model);

}  // namespace titop::detail
