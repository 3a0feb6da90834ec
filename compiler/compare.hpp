#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace titop::detail {

/// Where two transfers differ most.
struct Difference {
  double relative = 0;
  std::size_t point = 0;  ///< index
};

/// Two transfers at the same points: each entry's difference over the largest value that it takes
/// in `exact`, or over 1e-3 of what its row and column come to where it is all but 0 (rows and
/// columns below 1e-12 of all count as large as the largest). Not finite is infinitely far.
Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact);

}  // namespace titop::detail
