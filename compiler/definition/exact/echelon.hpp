#pragma once

#include <map>
#include <titop/compiler/definition/exact/residue.hpp>
#include <utility>
#include <vector>

/// Linear algebra without rounding: ranks. For the compiler's own files.
namespace titop::exact {

/// Entries that are not 0, by ascending column.
using SparseRow = std::vector<std::pair<int, Residue>>;

/// Columns with their entries; those of one column are added up.
using Entries = std::map<int, Residue>;

SparseRow to_row(const Entries& entries);

/// Rows in echelon form: every row has its own leading column, in which it is 1.
class Echelon {
 public:
  /// The row reduced by the rows here; empty if it depends on them.
  SparseRow reduced(SparseRow row) const;
  /// Adds the row, reduced. False if it depends on the others.
  bool add(SparseRow row);

  int rank() const { return static_cast<int>(rows_.size()); }
  /// By leading column.
  const std::map<int, SparseRow>& rows() const { return rows_; }

 private:
  std::map<int, SparseRow> rows_;
};

struct Square {
  std::vector<SparseRow> columns;
  SparseRow times(const SparseRow& v) const;
};

/// The smallest subspace with these rows that the matrix keeps: span(v, M v, M^2 v, ...). O(n^3) if
/// M is dense.
Echelon krylov(const Square& M, std::vector<SparseRow> start);

/// Rank of the products of the rows of a by the rows of b.
int rank_of_products(const Echelon& a, const Echelon& b);

}  // namespace titop::exact
