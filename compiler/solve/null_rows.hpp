#pragma once

#include <cmath>
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

/// A number for further sums: what has not lost much counts by itself, so that ordinary losses do
/// not add up along a long chain.
inline Kept settled(const Kept& k) {
  const double value = k.cleaned();
  return {value, std::abs(value) > 1e-4 * k.size ? std::abs(value) : k.size};
}

/// Many of them.
struct KeptMatrix {
  Eigen::MatrixXd value, size;

  KeptMatrix() = default;
  KeptMatrix(Eigen::Index rows, Eigen::Index columns)
      : value(Eigen::MatrixXd::Zero(rows, columns)), size(value) {}
  Kept at(Eigen::Index i, Eigen::Index j) const { return {value(i, j), size(i, j)}; }
  void set(Eigen::Index i, Eigen::Index j, const Kept& k) {
    value(i, j) = k.value, size(i, j) = k.size;
  }
  KeptMatrix transposed() const;
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

/// Rows p with p M = 0, each with 1 in a place of its own where the other ones have 0: elimination
/// with the pivot that has lost least, whatever the units. O(rows^2 columns).
NullRows left_null(KeptMatrix M);

/// x L = c for factors of L (c over the unknowns in the order of Plan::first; x over the scalar
/// rows), entries that cancel set to 0. O(fronts).
Eigen::RowVectorXd solve_transposed(const Factors<double>& factors, const Eigen::RowVectorXd& c);

}  // namespace titop::solve
