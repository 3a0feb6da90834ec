#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace titop::loops {

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
  /// Norm of a column, in the rows without a pivot.
  double norm(int column) const { return M_.col(column).tail(M_.rows() - done()).norm(); }
  /// The largest norm among these columns, of those without a pivot.
  double largest(const std::vector<int>& columns) const;

  /// Preference among pivots.
  struct PivotChoice {
    Eigen::VectorXd worth = {};  ///< per column: norms are multiplied by it; empty: all 1
    double share = 0;            ///< a pivot is worth more than this times the best of `rivals`
    std::vector<int> rivals = {};
    Eigen::Index most = std::numeric_limits<Eigen::Index>::max();  ///< pivots, with those before
  };
  /// Takes pivots among these columns, of norms above `least`: the one that is worth most first, of
  /// equals the first: no choice by rounding. Returns the largest remaining norm; 0 without rows.
  /// O(rows columns) per pivot.
  double take(const std::vector<int>& columns, double least, const PivotChoice& choice);
  double take(const std::vector<int>& columns, double least) { return take(columns, least, {}); }
  /// The smallest pivot.
  double weakest() const { return weakest_; }

 private:
  void reflect(int column);

  Eigen::MatrixXd M_;
  std::vector<int> pivots_ = {};
  std::vector<char> taken_;
  double weakest_ = 1;
};

}  // namespace titop::loops
