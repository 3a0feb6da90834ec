#pragma once

#include <functional>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/analysis/reduction/reduced_system.hpp>

/// The error of a reduced model over a scene's band. For the library's own files only.
namespace titop::detail {

/// Step of the phase grid: a bound of 1 / cos(1 / 2) = 1.14 times the samples.
constexpr double kPhase = 1;

using TransferOf = std::function<Eigen::MatrixXcd(std::complex<double>)>;

/// Error against the factored system, per pair relative to its own peak, at the points where the
/// two can differ most: the phase grid of the poles of both; plus rounding, except for pairs that
/// are 0 in both. Cost: the full system's transfers at these points, counted by `samples`.
ErrorBound error_bound(const System& full, const Scene& scene, const Band& band,
                       const SampledSpectrum& spectrum,
                       const std::vector<std::complex<double>>& poles, const TransferOf& transfer);

}  // namespace titop::detail
