#pragma once

#include <Eigen/Core>
#include <titop/compiler/minreal/modes.hpp>
#include <titop/compiler/realization/proportional.hpp>
#include <titop/graph/linalg/rounding.hpp>

/// Common to both kinds of modes: modes of one frequency, and ranks. For the compiler's own files.
namespace titop::minreal {

using linalg::kEpsilon;
inline constexpr double kClearRank =
    1e-6;  ///< least singular value, or entry of a unit vector, that is no rounding
inline constexpr double kClearRow = 1e-10;  ///< likewise of a whole row
inline const char* const kAtZero = "its pole is at 0";

template <class Matrix>
Matrix unit_columns(Matrix m) {
  for (Eigen::Index l = 0; l < m.cols(); ++l)
    if (const double n = m.col(l).norm(); n > 0) m.col(l) /= n;
  return m;
}

/// Rotates k modes of one frequency. Order of the new modes: excited and observed, excited alone,
/// not excited. b: k x inputs, c: k x outputs, each column of weight one. Returns the k x k unitary
/// matrix whose columns are the new modes. O(k^2 ports).
Eigen::MatrixXd turn(const Eigen::MatrixXd& b, const Eigen::MatrixXd& c);
Eigen::MatrixXcd turn(const Eigen::MatrixXcd& b, const Eigen::MatrixXcd& c);

/// Parts of a model that share no state, by number.
struct UncoupledParts {
  std::vector<int> of_state, of_mode;
  bool one() const;  ///< all modes are of one part
};
/// A mode is of the part of the state where it is largest; parts whose modes share a frequency
/// count as one. `vectors`: states x modes. O(n^2).
UncoupledParts find_parts(const Eigen::MatrixXd& A, const Eigen::MatrixXd& vectors,
                          const ModeSet& m);

/// Entries of vectors (states x modes) outside the part of their mode are rounding, and become 0.
template <class Matrix>
void keep_to_parts(const UncoupledParts& parts, Matrix&& vectors) {
  for (Eigen::Index j = 0; j < vectors.cols(); ++j)
    for (Eigen::Index i = 0; i < vectors.rows(); ++i)
      if (parts.of_state[static_cast<std::size_t>(i)] != parts.of_mode[static_cast<std::size_t>(j)])
        vectors(i, j) = 0;
}

/// Modes of one part may be of any size relative to those of another: an unobservable one with a
/// large response to an input would hide the others. Scales the inputs and the outputs of each
/// part, each by the largest of its port, to one size.
void balance_sides(const UncoupledParts& parts, ModeSet& m);

/// True if no combination of the rows of M vanishes up to rounding. A row far below the others
/// may itself be at rounding level.
bool clearly_full_rank(Eigen::MatrixXd M);

}  // namespace titop::minreal
