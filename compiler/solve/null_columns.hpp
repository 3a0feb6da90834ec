#pragma once

#include <titop/compiler/solve/null_rows.hpp>

namespace titop::solve {

/// Many sums, as columns.
struct KeptMatrix {
  Eigen::MatrixXd value, size;

  KeptMatrix() = default;
  KeptMatrix(Eigen::Index rows, Eigen::Index columns)
      : value(Eigen::MatrixXd::Zero(rows, columns)), size(value) {}
  CancellingSum at(Eigen::Index i, Eigen::Index j) const { return {value(i, j), size(i, j)}; }
  void set(Eigen::Index i, Eigen::Index j, const CancellingSum& k) {
    value(i, j) = k.value, size(i, j) = k.size;
  }
};

/// Columns z (unknowns x k, in the order of Plan::first) with L z = 0, k the rank deficiency of L:
/// the counterpart of `null_rows` for the same factors. Every z has 1 in one unknown, where the
/// others have 0. Entries that cancel are exactly 0; `size` is that of the terms of
/// the others, for sums of them. O(fronts) per patch; for patches that depend on each other as in
/// null_rows.
KeptMatrix null_columns(const Factors<double>& patched);

}  // namespace titop::solve
