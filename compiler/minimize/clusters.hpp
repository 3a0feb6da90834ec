#pragma once

#include <Eigen/Core>
#include <limits>
#include <titop/compiler/minimize/modes.hpp>

/// What both kinds of modes need: modes of one frequency, and ranks. For the compiler's own files.
namespace titop::modes {

inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr double kSameFrequency = 1e-9;  ///< relative: as close as this, modes are equal
inline constexpr double kNoPart = 1e-8;     ///< of a cluster's largest: what is below takes no part
inline constexpr double kClearRank = 1e-6;  ///< least singular value that rounding cannot have made
inline constexpr double kClearRow = 1e-10;  ///< likewise of a whole row
inline const char* const kAtZero = "its pole is at 0";

template <class Matrix>
Matrix unit_columns(Matrix m) {
  for (Eigen::Index l = 0; l < m.cols(); ++l)
    if (const double n = m.col(l).norm(); n > 0) m.col(l) /= n;
  return m;
}

/// Turns k modes of one frequency among themselves: first those that no input moves go to the end,
/// then, among the others, those that no output sees. b: k x inputs, c: k x outputs, each column of
/// weight one. Returns the k x k unitary matrix whose columns are the new modes. O(k^2 ports).
Eigen::MatrixXd turn(const Eigen::MatrixXd& b, const Eigen::MatrixXd& c);
Eigen::MatrixXcd turn(const Eigen::MatrixXcd& b, const Eigen::MatrixXcd& c);

/// True if no combination of the rows of M vanishes but for rounding. A row far below the others
/// may be nothing but rounding itself.
bool clearly_full_rank(Eigen::MatrixXd M);

}  // namespace titop::modes
