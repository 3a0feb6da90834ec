#include <titop/compiler/solve/null_columns.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using Eigen::Index;
using linalg::at;

/// F z = value e_row, front by front: L from the leaves to the root, then U back (substitution.cpp
/// with the size of every number's terms).
class UnitColumn {
 public:
  explicit UnitColumn(const Factors<double>& factors) : f_(factors), plan_(factors.plan()) {}

  const std::vector<CancellingSum>& solve(int row, double value) {
    row_ = row, value_ = value;
    z_.assign(at(plan_.unknowns), {});
    carried_.assign(at(plan_.carried), {});
    for (std::size_t f = 0; f < plan_.fronts.size(); ++f) upward(f);
    for (std::size_t f = plan_.fronts.size(); f-- > 0;) downward(f);
    return z_;
  }

 private:
  std::vector<CancellingSum> assembled(const Front& f) const {
    std::vector<CancellingSum> rows;
    rows.reserve(at(f.row_count));
    for (const int r : plan_.list(f.rows))
      for (int i = 0; i < plan_.structure.row_size[at(r)]; ++i)
        rows.push_back(plan_.row_first[at(r)] + i == row_ ? CancellingSum{value_, std::abs(value_)}
                                                          : CancellingSum{});
    for (const int c : plan_.list(f.children)) {
      const Front& child = plan_.fronts[at(c)];
      for (int i = 0; i < child.left_over(); ++i)
        rows.push_back(carried_[at(child.first_carried + i)]);
    }
    return rows;
  }

  void upward(std::size_t index) {
    const Front& f = plan_.fronts[index];
    const Factors<double>::Made& made = f_.made(index);
    const std::vector<CancellingSum> rows = assembled(f);
    std::vector<CancellingSum> b(rows.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = rows[at(made.order[i])];
    const std::ptrdiff_t n = f.columns();
    for (int i = 0; i < f.row_count; ++i) {
      for (int k = 0; k < std::min(i, f.pivot_count); ++k)
        pass(b[at(k)], made.lu[at(i * n + k)], b[at(i)]);
      b[at(i)] = settled(b[at(i)]);
    }
    for (int i = 0; i < f.pivot_count; ++i) z_[at(f.first_unknown + i)] = b[at(i)];
    for (int i = f.pivot_count; i < f.row_count; ++i)
      carried_[at(f.first_carried + i - f.pivot_count)] = b[at(i)];
  }

  void downward(std::size_t index) {
    const Front& f = plan_.fronts[index];
    const double* lu = f_.made(index).lu.data();
    const std::ptrdiff_t n = f.columns();
    for (int i = f.pivot_count - 1; i >= 0; --i) {
      CancellingSum& own = z_[at(f.first_unknown + i)];
      int column = f.pivot_count;
      for (const int v : plan_.list(f.border))
        for (int k = 0; k < plan_.structure.variable_size[at(v)]; ++k, ++column)
          pass(z_[at(plan_.first[at(v)] + k)], lu[i * n + column], own);
      for (int k = i + 1; k < f.pivot_count; ++k)
        pass(z_[at(f.first_unknown + k)], lu[i * n + k], own);
      const double pivot = lu[i * n + i];
      own = settled({own.value / pivot, own.size / std::abs(pivot)});
    }
  }

  static void pass(const CancellingSum& from, double factor, CancellingSum& to) {
    to.add(-factor * from.value, std::abs(factor) * from.size);
  }

  const Factors<double>& f_;
  const Plan& plan_;
  int row_ = 0;
  double value_ = 0;
  std::vector<CancellingSum> z_, carried_;
};

}  // namespace

// L = F - sum of value_i e_row_i e_unknown_i'. L z = 0 is F z = sum of value_i e_row_i q_i with q_i
// z at unknown i: z = Z q, Z the solutions for one patch each, and (I - Z at these unknowns) q = 0.
KeptMatrix null_columns(const Factors<double>& patched) {
  const std::vector<Patch> patches = patched.patches();
  const auto m = static_cast<int>(patches.size());
  std::vector<int> patch_at(at(patched.plan().unknowns), -1);
  for (int i = 0; i < m; ++i) patch_at[at(patches[at(i)].unknown)] = i;
  std::vector<std::vector<std::pair<int, CancellingSum>>> Z(at(m));
  SparseRows M(at(m));  // transposed
  UnitColumn column(patched);
  for (int j = 0; j < m; ++j) {
    const std::vector<CancellingSum>& z = column.solve(patches[at(j)].row, patches[at(j)].value);
    std::map<int, CancellingSum> row{{j, {1, 1}}};
    for (int r = 0; r < patched.plan().unknowns; ++r) {
      const CancellingSum& k = z[at(r)];
      if (k.size == 0) continue;
      Z[at(j)].emplace_back(r, k);
      if (const int i = patch_at[at(r)]; i >= 0) row[i].add(-k.value, k.size);
    }
    for (const auto& [i, k] : row)
      if (const double value = k.cleaned(); value != 0) M[at(j)][i] = {value, std::abs(value)};
  }
  const NullRows small = left_null(std::move(M));
  KeptMatrix result(patched.plan().unknowns, std::ssize(small.y));
  for (Index k = 0; k < result.value.cols(); ++k) {
    std::map<int, CancellingSum> sums;
    for (const auto& [j, factor] : small.y[at(k)])
      for (const auto& [r, z] : Z[at(j)]) sums[r].add(factor * z.value, std::abs(factor) * z.size);
    // At the patched unknowns z is q itself.
    std::erase_if(sums, [&](const auto& entry) { return patch_at[at(entry.first)] >= 0; });
    for (const auto& [j, factor] : small.y[at(k)])
      result.set(patches[at(j)].unknown, k, {factor, std::abs(factor)});
    for (const auto& [r, sum] : sums) result.set(r, k, settled(sum));
  }
  return result;
}

}  // namespace titop::solve
