#pragma once

#include <Eigen/Core>
#include <vector>

namespace titop::passes::closing {

/// Householder elimination of a dense matrix, row by row from the top, one pivot each; columns keep
/// their places.
class Reflections {
 public:
  explicit Reflections(Eigen::MatrixXd matrix)
      : M_(std::move(matrix)), taken_(static_cast<std::size_t>(M_.cols()), 0) {}
  const Eigen::MatrixXd& matrix() const { return M_; }
  /// Columns of the pivots, per row from the top.
  const std::vector<int>& pivots() const { return pivots_; }
  Eigen::Index done() const { return static_cast<Eigen::Index>(pivots_.size()); }
  bool taken(int column) const { return taken_[static_cast<std::size_t>(column)]; }
  /// Of a column, in the rows without a pivot.
  double norm(int column) const { return M_.col(column).tail(M_.rows() - done()).norm(); }
  /// Takes pivots among these columns while they are above `least` and above `share` times the
  /// largest of `rivals`, the largest first; of equals the first: no choice by rounding. Returns
  /// the largest that is left. O(rows columns) per pivot.
  double take(const std::vector<int>& columns, double least, double share = 0,
              const std::vector<int>& rivals = {});
  /// The smallest pivot.
  double weakest() const { return weakest_; }

 private:
  double largest(const std::vector<int>& columns) const;
  void reflect(int column);

  Eigen::MatrixXd M_;
  std::vector<int> pivots_ = {};
  std::vector<char> taken_;
  double weakest_ = 1;
};

}  // namespace titop::passes::closing
