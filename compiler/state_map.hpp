#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/compiler/stage.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::detail {

struct Layout;

/// From the states of the model to those of all blocks, x_blocks = T x: the map that pass `close`
/// found, applied around the solve. The model is A_kept = (A T)(kept rows), C = C T.
class StateMap {
 public:
  StateMap() = default;
  StateMap(const std::vector<Dependent>& dependents, const Layout& layout);

  bool trivial() const { return rows_.empty(); }
  const std::vector<int>& kept() const { return kept_; }  ///< among the blocks' states
  const std::vector<std::string>& names() const { return names_; }
  int order() const { return static_cast<int>(kept_.size()); }

  /// One dependent state: sum of factor * x(place).
  struct Row {
    int state = -1;  ///< among the blocks' states
    std::vector<std::pair<int, double>> of;
  };
  const std::vector<Row>& dependent() const { return rows_; }

  /// T x: blocks' states x columns. O(entries of T) per column.
  template <class Matrix>
  Matrix expanded(const Matrix& x) const {
    if (trivial()) return x;
    Matrix all(static_cast<Eigen::Index>(kept_.size() + rows_.size()), x.cols());
    for (std::size_t i = 0; i < kept_.size(); ++i)
      all.row(kept_[i]) = x.row(static_cast<Eigen::Index>(i));
    for (const Row& row : rows_) {
      all.row(row.state).setZero();
      for (const auto& [place, factor] : row.of)
        all.row(row.state) += typename Matrix::Scalar(factor) * x.row(place);
    }
    return all;
  }
  /// The kept rows of a matrix over all blocks' states.
  template <class Matrix>
  Matrix kept_rows(const Matrix& all) const {
    if (trivial()) return all;
    return all(kept_, Eigen::all);
  }
  /// The model of all blocks' states becomes the model of the kept ones; entries that cancel to
  /// rounding (64 units) are 0. O(order * entries of T).
  void reduce(StateSpace& model) const;

 private:
  std::vector<int> kept_;
  std::vector<std::string> names_;
  std::vector<Row> rows_;
};

}  // namespace titop::detail
