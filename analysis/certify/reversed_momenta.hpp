#pragma once

#include <complex>
#include <optional>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

namespace titop::certification {

/// The diagram with the sign of all gyroscopic terms changed: its rotors spin the other way round.
/// None if it has no such terms.
std::optional<Graph> reversed_momenta(const Graph& graph, ParameterValues values);

/// The transfers between these forces and motions of that diagram, compiled anew with these
/// options. Empty if it has no gyroscopic terms. Throws the errors of `compile` and
/// `System::transfer`.
std::vector<Eigen::MatrixXcd> with_reversed_momenta(
    const Graph& graph, ParameterValues values, Options options, const passes::DualPairs& pairs,
    const std::vector<std::complex<double>>& points);

}  // namespace titop::certification
