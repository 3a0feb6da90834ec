#pragma once

#include <Eigen/Core>
#include <titop/compiler/definition/exact/integers.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

/// Doubles as fractions. For the compiler's own files.
namespace titop::exact {

/// Dense, row by row.
struct FractionMatrix {
  Eigen::Index rows = 0, cols = 0;
  std::vector<Fraction> entries;

  FractionMatrix(Eigen::Index r, Eigen::Index c)
      : rows(r), cols(c), entries(static_cast<std::size_t>(r * c)) {}
  Fraction& operator()(Eigen::Index i, Eigen::Index j) {
    return entries[static_cast<std::size_t>(i * cols + j)];
  }
  const Fraction& operator()(Eigen::Index i, Eigen::Index j) const {
    return entries[static_cast<std::size_t>(i * cols + j)];
  }
  static FractionMatrix identity(Eigen::Index n);
  FractionMatrix transposed() const;
};
FractionMatrix operator*(const FractionMatrix& a, const FractionMatrix& b);
FractionMatrix operator*(const Fraction& k, FractionMatrix m);

/// Every double as the fraction that it is.
FractionMatrix fractions(const Eigen::MatrixXd& m);

/// Orthonormal rows as the nearby fractions of small denominator: 0.6 is 3/5. Throws Undecided,
/// with `subject`, if there are none, or if they are not orthonormal.
FractionMatrix orthonormal_fractions(const Eigen::MatrixXd& rows, const std::string& subject);

/// The matrix of a term, as `coefficient` of graph.hpp. Throws Undecided.
FractionMatrix exact_coefficient(const Graph& graph, const Term& term, ParameterValues values);

}  // namespace titop::exact
