#pragma once

#include <complex>
#include <titop/compiler/solve/factored.hpp>
#include <vector>

namespace titop::detail {

/// Factor within which an s resolves a frequency.
inline constexpr double kNear = 3;

/// Largest entries of the outputs of one unit, column by column; `units`: sizes of the outputs that
/// share one.
Eigen::MatrixXd by_unit(const solve::RowMatrix<std::complex<double>>& y,
                        const std::vector<int>& units);

/// Points at which the dense model is tried, and the limit below which |s| no mode shows; 0: not
/// known.
struct Tried {
  std::vector<std::complex<double>> s;
  double slowest = 0;
};

/// Far below, at and above the blocks' frequencies, and at the assembly's; below the slowest of the
/// blocks', and at and below the slowest mode that shows, if those are lower still. That is
/// looked for below all blocks: two that are far apart have decades without a mode between them.
/// u: inputs x columns; `units`: as by_unit. O(bodies) per decade.
Tried tried(const Factored& data, const Eigen::MatrixXd& A,
            const solve::RowMatrix<std::complex<double>>& u, const std::vector<int>& units);

}  // namespace titop::detail
