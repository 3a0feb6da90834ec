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

/// Points: 1e-4, 1e-2, 1 and 100 times pick_s; the assembly's frequencies, where no point is near;
/// 1e-2 of the slowest block's frequency, if that is below 1e-2 |pick_s|; the slowest mode with an
/// effect on the outputs, if it is below |pick_s| / 2, and 1e-2 of it, if it is below 2e-2
/// |pick_s|. This mode is searched from the slowest block downwards: between two frequencies that
/// are far apart are decades without a mode. u: inputs x columns; `units`: as by_unit. O(bodies)
/// per decade.
Tried tried(const Factored& data, const Eigen::MatrixXd& A,
            const solve::RowMatrix<std::complex<double>>& u, const std::vector<int>& units);

}  // namespace titop::detail
