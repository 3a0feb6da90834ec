#pragma once

#include <titop/compiler/definition/compare.hpp>

namespace titop::detail {

struct SystemData;

/// Size of the terms that cancel inside the elimination, outputs x inputs: kTermsPerRounding times
/// the difference between the transfers in double and in long double, the largest at these points.
/// A point at which one of the two has no digit is omitted. Complements `terms` of a model or graph
/// (compiler/definition/compare.hpp). O(bodies) per point, in long double.
Eigen::MatrixXd terms(const SystemData& data, const std::vector<std::complex<double>>& points);

/// Largest difference between the transfers `a` and `exact` at these points, in the blocks of
/// `measure` (compiler/definition/compare.hpp). `exact` are the system's own transfers. If it
/// exceeds kWarn, the terms of the elimination at up to 8 of the points are added to `measure`,
/// and the difference is computed again.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, Measure& measure,
                      const SystemData& data, const std::vector<std::complex<double>>& points);

}  // namespace titop::detail
