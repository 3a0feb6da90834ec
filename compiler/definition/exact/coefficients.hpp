#pragma once

#include <Eigen/Core>
#include <titop/compiler/definition/exact/echelon.hpp>
#include <titop/compiler/definition/exact_order.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

/// Matrices of the equations without rounding. For the compiler's own files.
namespace titop::exact {

/// Dense, row by row.
struct ExactMatrix {
  Eigen::Index rows = 0, cols = 0;
  std::vector<Residue> entries;

  ExactMatrix(Eigen::Index r, Eigen::Index c)
      : rows(r), cols(c), entries(static_cast<std::size_t>(r * c)) {}
  Residue& operator()(Eigen::Index i, Eigen::Index j) {
    return entries[static_cast<std::size_t>(i * cols + j)];
  }
  const Residue& operator()(Eigen::Index i, Eigen::Index j) const {
    return entries[static_cast<std::size_t>(i * cols + j)];
  }
  static ExactMatrix identity(Eigen::Index n);
  ExactMatrix transposed() const;
};
ExactMatrix operator*(const ExactMatrix& a, const ExactMatrix& b);
ExactMatrix operator*(const Residue& k, ExactMatrix m);

/// Every entry as the fraction that it is. Throws Undecided if one is not finite.
ExactMatrix exact_matrix(const Eigen::MatrixXd& m);

/// Orthonormal rows as the nearby fractions of small denominator: 0.6 is 3/5. Throws Undecided,
/// with `subject`, if there are none, or if they are not orthonormal.
ExactMatrix orthonormal_fractions(const Eigen::MatrixXd& rows, const std::string& subject);

/// A rotation within rounding of this one (of which T T' = I up to rounding) that is exact: that of
/// its quaternion in double. Rotations about one axis of the frame keep it; the inverse gives the
/// inverse.
ExactMatrix nearest_rotation(const Matrix3d& T);

/// The matrix of a term, as `coefficient` of graph.hpp. Throws Undecided.
ExactMatrix exact_coefficient(const Graph& graph, const Term& term, ParameterValues values,
                              ExactRotations rotations = ExactRotations::fractions);

}  // namespace titop::exact
