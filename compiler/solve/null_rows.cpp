#include <algorithm>
#include <optional>
#include <set>
#include <titop/compiler/solve/null_rows.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

namespace titop::solve {
namespace {

using linalg::at;

/// Rows x with x L = c for factors of L, where c has one entry: first U transposed from its front
/// towards the root, then L transposed back. Fronts with zeros only are skipped: the cost of a
/// junction's dependence is that of its neighbours, not of the whole scene.
class Transposed {
 public:
  explicit Transposed(const Factors<double>& factors)
      : f_(factors),
        plan_(factors.plan()),
        front_of_(at(plan_.unknowns)),
        c_(at(plan_.unknowns)),
        carried_(at(plan_.carried)) {
    for (int f = 0; f < static_cast<int>(plan_.fronts.size()); ++f)
      std::fill_n(front_of_.begin() + plan_.fronts[at(f)].first_unknown,
                  plan_.fronts[at(f)].pivot_count, f);
  }

  SparseRow solve(int unknown, double value) {
    c_[at(unknown)] = {value, std::abs(value)};
    std::set<int> fronts{front_of_[at(unknown)]};
    for (auto f = fronts.begin(); f != fronts.end(); ++f) upward(*f, fronts);
    x_.clear();
    for (; !fronts.empty(); ++fronts_) {
      const int last = *fronts.rbegin();
      fronts.erase(last);
      downward(last, fronts);
    }
    std::sort(x_.begin(), x_.end());
    return x_;
  }

  std::size_t fronts() const { return fronts_; }

 private:
  /// `fronts`: adds those further up with nonzero entries.
  void upward(int index, std::set<int>& fronts) {
    const Front& f = plan_.fronts[at(index)];
    const double* lu = f_.made(at(index)).lu.data();
    const std::ptrdiff_t n = f.columns();
    for (int k = 0; k < f.pivot_count; ++k) {
      CancellingSum& own = c_[at(f.first_unknown + k)];
      const double pivot = lu[k * n + k];
      own = settled({own.value / pivot, own.size / std::abs(pivot)});
      if (own.size == 0) continue;
      for (int j = k + 1; j < f.pivot_count; ++j)
        pass(own, lu[k * n + j], c_[at(f.first_unknown + j)]);
      int column = f.pivot_count;
      for (const int v : plan_.list(f.border))
        for (int i = 0; i < plan_.structure.variable_size[at(v)]; ++i, ++column)
          pass(own, lu[k * n + column], c_[at(plan_.first[at(v)] + i)]);
    }
    for (const int v : plan_.list(f.border))
      for (int i = 0; i < plan_.structure.variable_size[at(v)]; ++i)
        if (const int unknown = plan_.first[at(v)] + i; c_[at(unknown)].size != 0)
          fronts.insert(front_of_[at(unknown)]);
  }

  /// Resets to 0 the entries that it reads. `fronts`: adds children with nonzero entries.
  void downward(int index, std::set<int>& fronts) {
    const Front& f = plan_.fronts[at(index)];
    const Factors<double>::Made& made = f_.made(at(index));
    const std::ptrdiff_t n = f.columns();
    std::vector<CancellingSum> b(at(f.row_count));
    for (int i = 0; i < f.row_count; ++i)
      b[at(i)] =
          std::exchange(i < f.pivot_count ? c_[at(f.first_unknown + i)]
                                          : carried_[at(f.first_carried + i - f.pivot_count)],
                        {});
    for (int k = f.pivot_count - 1; k >= 0; --k) {
      for (int i = k + 1; i < f.row_count; ++i) pass(b[at(i)], made.lu[at(i * n + k)], b[at(k)]);
      b[at(k)] = settled(b[at(k)]);
    }
    std::vector<CancellingSum> assembled(b.size());
    for (std::size_t i = 0; i < b.size(); ++i) assembled[at(made.order[i])] = b[i];
    int place = 0;
    for (const int r : plan_.list(f.rows))
      for (int i = 0; i < plan_.structure.row_size[at(r)]; ++i)
        if (const double x = assembled[at(place++)].value; x != 0)
          x_.emplace_back(plan_.row_first[at(r)] + i, x);
    for (const int c : plan_.list(f.children)) {
      const Front& child = plan_.fronts[at(c)];
      for (int i = 0; i < child.left_over(); ++i) {
        const CancellingSum& k = carried_[at(child.first_carried + i)] = assembled[at(place++)];
        if (k.size != 0) fronts.insert(c);
      }
    }
  }

  static void pass(const CancellingSum& from, double factor, CancellingSum& to) {
    to.add(-factor * from.value, std::abs(factor) * from.size);
  }

  const Factors<double>& f_;
  const Plan& plan_;
  std::vector<int> front_of_;               ///< per unknown
  std::vector<CancellingSum> c_, carried_;  ///< 0 between solutions
  SparseRow x_;
  std::size_t fronts_ = 0;
};

/// p M = 0 by row operations.
class LeftNull {
 public:
  explicit LeftNull(SparseRows m) : M_(std::move(m)) {
    for (int i = 0; i < static_cast<int>(M_.size()); ++i)
      rows_.push_back(i), by_.push_back({{i, 1.0}});
  }

  NullRows solve() {
    while (const auto found = pivot()) take_out(found->first, found->second);
    NullRows result;
    for (const int r : rows_) {
      result.y.emplace_back();
      for (const auto& [i, value] : by_[at(r)])
        if (value != 0) result.y.back().emplace_back(i, value);
    }
    result.own = std::move(rows_);
    return result;
  }

 private:
  /// Row and column of the entry with the least cancellation.
  std::optional<std::pair<int, int>> pivot() const {
    std::optional<std::pair<int, int>> best;
    double score = 0;
    for (const int r : rows_)
      for (const auto& [c, k] : M_[at(r)]) {
        if (k.value == 0) continue;
        // The diagonal is a pure number; the others have their rows' and columns' units.
        const double share = std::abs(k.value) / k.size * (r == c ? 2 : 1);
        if (share > score) score = share, best = {r, c};
      }
    return best;
  }

  void take_out(int row, int column) {
    std::erase(rows_, row);
    const CancellingSum own = M_[at(row)].at(column);
    M_[at(row)].erase(column);
    for (const int i : rows_) {
      const auto found = M_[at(i)].find(column);
      if (found == M_[at(i)].end()) continue;
      const double l = found->second.value / own.value;
      M_[at(i)].erase(found);
      if (l == 0) continue;
      for (const auto& [j, k] : M_[at(row)]) {
        CancellingSum& sum = M_[at(i)][j];
        sum.add(-l * k.value, std::abs(l) * k.size);
        sum.value = sum.cleaned();
      }
      for (const auto& [j, value] : by_[at(row)]) by_[at(i)][j] -= l * value;
    }
  }

  SparseRows M_;
  std::vector<int> rows_;                  ///< not pivots yet
  std::vector<std::map<int, double>> by_;  ///< row operations so far: M now = by * M before
};

/// p' Y; sums that cancel are 0.
SparseRow combined(const SparseRow& p, const std::vector<SparseRow>& Y) {
  std::map<int, CancellingSum> sums;
  for (const auto& [i, factor] : p)
    for (const auto& [place, value] : Y[at(i)])
      sums[place].add(factor * value, std::abs(factor * value));
  SparseRow result;
  for (const auto& [place, sum] : sums)
    if (const double value = sum.cleaned(); value != 0) result.emplace_back(place, value);
  return result;
}

}  // namespace

NullRows left_null(SparseRows M) { return LeftNull(std::move(M)).solve(); }

// L = F - sum of value_i e_row_i e_unknown_i', F the factored matrix. y L = 0 is y F = p' Q with p
// = y at the patched rows: y = p' Y, Y = Q F^-1, and p' (I - Y at these rows) = 0.
NullRows null_rows(const Factors<double>& patched) {
  const std::vector<Patch> patches = patched.patches();
  const auto m = static_cast<int>(patches.size());
  std::vector<int> patch_at(at(patched.plan().unknowns), -1);
  for (int i = 0; i < m; ++i) patch_at[at(patches[at(i)].row)] = i;
  std::vector<SparseRow> Y;
  SparseRows M(at(m));
  Transposed transposed(patched);
  for (int i = 0; i < m; ++i) {
    Y.push_back(transposed.solve(patches[at(i)].unknown, patches[at(i)].value));
    std::map<int, CancellingSum> row{{i, {1, 1}}};
    for (const auto& [place, y] : Y.back())
      if (const int j = patch_at[at(place)]; j >= 0) row[j].add(-y, std::abs(y));
    for (const auto& [j, k] : row)
      if (const double value = k.cleaned(); value != 0) M[at(i)][j] = {value, std::abs(value)};
  }
  NullRows result = left_null(std::move(M));
  result.fronts = transposed.fronts();
  for (SparseRow& y : result.y) {
    const SparseRow p = std::move(y);
    y = combined(p, Y);
    // At the patched rows y is p itself.
    std::erase_if(y, [&](const auto& entry) { return patch_at[at(entry.first)] >= 0; });
    for (const auto& [i, value] : p) y.emplace_back(patches[at(i)].row, value);
    std::sort(y.begin(), y.end());
  }
  for (int& own : result.own) own = patches[at(own)].row;
  return result;
}

}  // namespace titop::solve
