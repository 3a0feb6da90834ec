#pragma once

#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {

/// What cancellation leaves below this share of its terms is 0, where the rank is decided.
constexpr double kCancelled = 1e-11;

/// Sums of numbers that may cancel, each with the size of what it was made of.
struct Kept {
  double value = 0, size = 0;

  void add(double term, double term_size) { value += term, size += term_size; }
  /// 0 where only rounding is left.
  double cleaned() const { return std::abs(value) <= kCancelled * size ? 0 : value; }
};

/// Rows y (k x scalar rows, in the order of Plan::row_first) with y L = 0, k the rank that L lacks,
/// from factors with patches in place of its missing pivots. Every y is one minimal dependence
/// among rows: it has 1 in a row of its own (`own`), where the other ones have 0. Entries that
/// cancel are exactly 0. O(fronts) per patch.
struct NullRows {
  Eigen::MatrixXd y;
  std::vector<int> own;
};
NullRows null_rows(const Factors<double>& patched);

/// x L = c for factors of L (c over the unknowns in the order of Plan::first; x over the scalar
/// rows), entries that cancel set to 0. O(fronts).
Eigen::RowVectorXd solve_transposed(const Factors<double>& factors, const Eigen::RowVectorXd& c);

}  // namespace titop::solve
