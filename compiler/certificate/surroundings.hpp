#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/null_rows.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <vector>

/// Sizes of the unknowns that are eliminated together with an unknown: the scale of its rounding.
/// For the compiler's own files only.
namespace titop::detail {

/// Times its Surroundings: possible rounding of a 0.
using solve::kLeftOfZero;

/// Times the largest of its kind, or the geometric mean of the largest in its row and column:
/// possible rounding of a 0 that chains enforce, or rotations (cos(pi / 2) = 6e-17), as of a sum
/// around a chain of some tens of joints.
using linalg::kProductRounding;

/// Size around an unknown in the elimination, in the unknown's own unit (by the scaling of the
/// fronts' columns): the largest of its front; if all that the front shares with its parent is
/// rounding of a 0 there, as behind a gain of 0, the front may be rounding, too, and the parent's
/// magnitude is used. Of the joint system as written.
class Surroundings {
 public:
  /// One column of unknowns, which must outlive this object.
  Surroundings(const Factored& data, const solve::RowMatrix<double>& unknowns)
      : d_(data), unknowns_(unknowns) {}

  /// Around an entry of a signal in terms of unknowns; 0 of a known one. O(1), once O(unknowns).
  double size(int signal, Eigen::Index entry);

 private:
  double of_variable(int variable, Eigen::Index entry);
  /// Once that of its parent is known.
  double of_front(const solve::Front& front) const;

  const Factored& d_;
  const solve::RowMatrix<double>& unknowns_;
  std::vector<double> sizes_ = {};  ///< per front, in the scale of its columns
};

}  // namespace titop::detail
