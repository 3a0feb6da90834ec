#pragma once

#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/system.hpp>

namespace titop::detail {

/// The same for cancellation inside the elimination, estimated from its rounding: kTermsPerRounding
/// times double against long double at these points. Slow.
Eigen::MatrixXd terms(const System& system, const std::vector<std::complex<double>>& points);

/// The same for an `exact` that is the system's own at these points. If that is above kClose,
/// the terms of the elimination, at up to 8 of the points, join the measure first.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact, Measure& measure,
                      const System& system, const std::vector<std::complex<double>>& points);

}  // namespace titop::detail
