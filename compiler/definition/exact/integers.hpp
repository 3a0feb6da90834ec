#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Linear algebra in integers of any length: ranks without rounding. For the compiler's own files.
namespace titop::exact {

using Integer = boost::multiprecision::cpp_int;
using Fraction = boost::multiprecision::cpp_rational;

/// Internal exception: the reason why the order is not decided.
struct Undecided {
  std::string why;
};

/// Entries that are not 0, by ascending column. Only the direction counts: any multiple will do.
using IntegerRow = std::vector<std::pair<int, Integer>>;

/// Columns with their fractions, in any order and with repetitions, which are added up.
using Fractions = std::map<int, Fraction>;

/// The shortest integer row in the same direction. O(entries).
IntegerRow to_row(const Fractions& entries);

/// Rows in echelon form: every row has its own leading column.
class Echelon {
 public:
  explicit Echelon(int bits) : bits_(bits) {}

  /// The row reduced by the rows here; empty if it depends on them.
  IntegerRow reduced(IntegerRow row) const;
  /// Adds the row, reduced. False if it depends on the others. Throws Undecided beyond `bits`.
  bool add(IntegerRow row);

  int rank() const { return static_cast<int>(rows_.size()); }
  /// By leading column.
  const std::map<int, IntegerRow>& rows() const { return rows_; }

 private:
  int bits_;
  std::map<int, IntegerRow> rows_;
};

/// A square matrix over one common denominator, which does not matter to its invariant subspaces.
struct Square {
  std::vector<std::vector<std::pair<int, Integer>>> columns;
  IntegerRow times(const IntegerRow& v) const;
};

/// The smallest subspace with these rows that the matrix keeps: span(v, M v, M^2 v, ...). Cost
/// O(n^3) operations on integers that grow as n^2, if M is dense.
Echelon krylov(const Square& M, std::vector<IntegerRow> start, int bits);

/// Rank of the products of the rows of a by the rows of b.
int rank_of_products(const Echelon& a, const Echelon& b, int bits);

}  // namespace titop::exact
