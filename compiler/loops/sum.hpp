#pragma once

#include <array>
#include <titop/compiler/loops/form.hpp>
#include <utility>
#include <vector>

namespace titop::loops {

/// Units of rows among the six of a point (or its one): 0 for a translation, 1 for a rotation.
std::vector<int> units_of_rows(const Eigen::MatrixXd& S);

/// A form that is summed along the ways round a chain, with the rounding of its entries. Rows are
/// scaled by their entries later: a row at rounding level, of a direction without a constraint,
/// would then become one.
class RoundedSum {
 public:
  /// `units`: per row 0 for a translation, 1 for a rotation.
  explicit RoundedSum(std::vector<int> units) : units_(std::move(units)) {}
  /// A factor that is met on a way: products with it, and with those after it, round in proportion.
  /// Translations and rotations have each their own unit, if there are six columns.
  void meet(const Eigen::MatrixXd& factor);
  /// += factor * own; the factor has been met.
  void add(const Eigen::MatrixXd& factor, const Form& own);
  /// The longest lever met: of a rotation in a translation [m]; 0: none.
  double lever() const { return of_six_[0][1]; }

  /// With entries below their rounding set to 0, and columns of zeros dropped.
  Form cleaned() const;

 private:
  std::vector<int> units_;
  Form form_, rounding_;
  using Largest = std::array<std::array<double, 2>, 2>;  ///< of rows, of columns
  Largest most_ = {}, of_six_ = {};  ///< of all factors; of those with six columns
  double factors_ = 0;
};

}  // namespace titop::loops
