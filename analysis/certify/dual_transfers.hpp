#pragma once

#include <complex>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

namespace titop::certification {

/// The transfers between them, at some points.
struct DualTransfers {
  std::vector<std::complex<double>> points;
  std::vector<Eigen::MatrixXcd> G;  ///< forces x forces
  detail::Measure by;               ///< the same blocks of rows and of columns
  /// G of the structure with all momenta reversed; empty if it has none.
  std::vector<Eigen::MatrixXcd> reversed = {};

  /// Possible rounding of a 0 in this block of rows and columns; 0 if it is not known.
  double floor(Eigen::Index row, Eigen::Index column, Eigen::Index rows,
               Eigen::Index columns) const;
};

/// Selects them from transfers in the declared order.
DualTransfers dual_transfers(const passes::DualPairs& pairs,
                             const std::vector<std::complex<double>>& points,
                             const std::vector<Eigen::MatrixXcd>& transfers);

/// The same with a floor for blocks at rounding level: by transfers in double and
/// in long double at all points. Slow.
DualTransfers with_rounding(const System& system, const passes::DualPairs& pairs,
                            DualTransfers transfers);

}  // namespace titop::certification
