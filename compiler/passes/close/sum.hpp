#pragma once

#include <array>
#include <titop/compiler/passes/close/form.hpp>

namespace titop::passes::closing {

/// A form that is added up along the ways round a chain, with the rounding that is in its entries.
/// Rows are scaled by what they have: a row of which rounding alone is left, because a chain says
/// nothing there, would say that something does not move.
class Sum {
 public:
  /// A factor that is met on a way: products with it, and with those after it, round in proportion.
  /// Translations and rotations, where there are six rows or columns, have each their own unit.
  void meet(const Eigen::MatrixXd& factor);
  /// += factor * own; the factor has been met.
  void add(const Eigen::MatrixXd& factor, const Form& own);
  /// Largest entry of `gap` (same rows) over the largest met there, of factors with as many
  /// columns: others are in other units.
  double relative(const Eigen::MatrixXd& gap) const;

  /// Entries below their rounding are 0; columns of nothing else are left out.
  Form cleaned() const;

 private:
  Form form_, rounding_;
  using Largest = std::array<std::array<double, 2>, 2>;  ///< of rows, of columns
  Largest most_ = {}, most_of_six_ = {};  ///< of all factors; of those with six columns
  double factors_ = 0;
};

}  // namespace titop::passes::closing
