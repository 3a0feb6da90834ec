#pragma once

#include <cmath>
#include <map>
#include <titop/compiler/solve/elimination.hpp>
#include <utility>
#include <vector>

namespace titop::solve {

/// Sums below this share of their terms are 0 in decisions on rank.
constexpr double kCancelled = 1e-11;
/// Possible rounding of a 0, relative to the sizes around it: some hundred units of the last place,
/// since it comes from sums over a front.
constexpr double kLeftOfZero = 1e-13;
/// A sum above this share of its terms has lost ordinary digits only.
constexpr double kOrdinary = 1e-4;

/// Sums of numbers that may cancel, each with the size of its terms.
struct CancellingSum {
  double value = 0, size = 0;

  void add(double term, double term_size) { value += term, size += term_size; }
  /// 0 at rounding level.
  double cleaned() const { return std::abs(value) <= kCancelled * size ? 0 : value; }
};

/// A number for further sums: its size becomes that of its value unless much has cancelled, so that
/// ordinary losses do not accumulate along a long chain.
inline CancellingSum settled(const CancellingSum& k) {
  const double value = k.cleaned();
  return {value, std::abs(value) > kOrdinary * k.size ? std::abs(value) : k.size};
}

/// Places and values of nonzero entries, ascending.
using SparseRow = std::vector<std::pair<int, double>>;

/// Rows by their entries; others are 0.
using SparseRows = std::vector<std::map<int, CancellingSum>>;

/// Rows y (places: scalar rows, in the order of Plan::row_first) with y L = 0, as many as the
/// rank deficiency of L, from factors with patches in place of its missing pivots. Every y is one
/// minimal dependence among rows: it has 1 in one row (`own`), where the others have 0. Entries
/// that cancel are exactly 0. For each patch O(fronts that its dependence reaches), which are few
/// for a junction without mass; then O(k^2 entries) for k patches that depend on each other.
struct NullRows {
  std::vector<SparseRow> y;
  std::vector<int> own;
  std::size_t fronts = 0;  ///< visited, all patches together
};
NullRows null_rows(const Factors<double>& patched);

/// Rows p with p M = 0, each with 1 in a place of its own where the other ones have 0: elimination
/// with the pivot of least cancellation, in any units. O(entries of M) per pivot.
NullRows left_null(SparseRows M);

}  // namespace titop::solve
