#pragma once

#include <titop/compiler/loops/relations.hpp>

namespace titop::loops {

/// Directions among a block's rows (k x rows, orthonormal) in which they follow from the blocks
/// before it.
struct Redundant {
  Eigen::MatrixXd directions;
  double weakest = 1;  ///< smallest singular value that counts
  double dropped = 0;  ///< largest that does not
  bool doubtful() const { return weakest < kNarrow || dropped > kNothing; }
};

/// Redundancy of scaled relations.
struct Redundancy {
  std::vector<Redundant> blocks = {};  ///< per block
  std::vector<int> held = {};          ///< columns that are 0 in all solutions of the relations
  int widest = 0;                      ///< columns that were open at once
};

/// Rows with columns that no others have are independent of them: they are set aside
/// until every remaining column has more than one block, or the rows there less than full rank
/// (pivots of 1e-3). The rest is decided in order, by singular values above kMatrixDigits of the
/// new part; decided rows are set aside in turn, as soon as no block to come has their columns. A
/// column is held if its unit vector is in the span of all rows. O(entries) if every chain has a
/// body of its own; else rows * open^2, `open` the columns between a block and those to come: a few
/// if blocks come `along` a truss.
Redundancy redundancy(const Relations& scaled);

}  // namespace titop::loops
