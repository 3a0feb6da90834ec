#include <algorithm>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/propagation.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

constexpr std::ptrdiff_t kTile = 16;  ///< columns whose sums stay in registers

}  // namespace

TITOP_WIDE void multiply_add(std::ptrdiff_t rows, std::ptrdiff_t inner, std::ptrdiff_t m,
                             const double* a, std::ptrdiff_t stride, const double* x, double* y) {
  std::ptrdiff_t j = 0;
  for (; j + kTile <= m; j += kTile)
    for (std::ptrdiff_t i = 0; i < rows; ++i) {
      double sum[kTile];
      for (std::ptrdiff_t t = 0; t < kTile; ++t) sum[t] = y[i * m + j + t];
      for (std::ptrdiff_t k = 0; k < inner; ++k) {
        const double f = a[i * stride + k];
        for (std::ptrdiff_t t = 0; t < kTile; ++t) sum[t] += f * x[k * m + j + t];
      }
      for (std::ptrdiff_t t = 0; t < kTile; ++t) y[i * m + j + t] = sum[t];
    }
  for (std::ptrdiff_t i = 0; j < m && i < rows; ++i)
    for (std::ptrdiff_t k = 0; k < inner; ++k)
      add(m - j, a[i * stride + k], x + k * m + j, y + i * m + j);
}

Propagation::Propagation(const Factors<double>& factors)
    : factors_(factors), plan_(factors.plan()) {
  std::size_t total = 0;
  for (const Front& f : plan_.fronts) {
    begin_.push_back(total);
    total += at(f.pivot_count) * at(f.border_count);
  }
  border_.resize(total);
  for (std::size_t i = 0; i < plan_.fronts.size(); ++i) {
    const Front& f = plan_.fronts[i];
    const std::vector<double>& lu = factors.made(i).lu;
    const std::ptrdiff_t n = f.columns(), b = f.border_count;
    double* const w = border_.data() + begin_[i];
    for (std::ptrdiff_t r = f.pivot_count - 1; r >= 0; --r) {
      double* const row = w + r * b;
      for (std::ptrdiff_t j = 0; j < b; ++j) row[j] = -lu[at(r * n + f.pivot_count + j)];
      for (std::ptrdiff_t k = r + 1; k < f.pivot_count; ++k)
        subtract(b, lu[at(r * n + k)], w + k * b, row);
      for (std::ptrdiff_t j = 0; j < b; ++j) row[j] /= lu[at(r * n + r)];
    }
  }
}

void Propagation::forward(int index, std::ptrdiff_t m, Space& space) const {
  const Front& f = plan_.fronts[at(index)];
  const auto& made = factors_.made(at(index));
  space.assembled.assign(at(f.row_count) * at(m), 0);
  std::ptrdiff_t row = 0;
  for (const int r : plan_.list(f.rows)) {
    const int size = plan_.structure.row_size[at(r)];
    std::copy_n(space.rows.data() + plan_.row_first[at(r)] * m, size * m,
                space.assembled.data() + row * m);
    row += size;
  }
  for (const int c : plan_.list(f.children)) {
    const Front& child = plan_.fronts[at(c)];
    if (space.is_active[at(c)])
      std::copy_n(space.carried.data() + child.first_carried * m, child.left_over() * m,
                  space.assembled.data() + row * m);
    row += child.left_over();
  }
  const std::ptrdiff_t n = f.columns();
  double* const top = space.z.data() + f.first_unknown * m;
  double* const rest = space.carried.data() + f.first_carried * m;
  const auto place = [&](std::ptrdiff_t i) {
    return i < f.pivot_count ? top + i * m : rest + (i - f.pivot_count) * m;
  };
  for (int i = 0; i < f.row_count; ++i)
    std::copy_n(space.assembled.data() + made.order[at(i)] * m, m, place(i));
  for (std::ptrdiff_t i = 1; i < f.row_count; ++i)
    for (std::ptrdiff_t k = 0; k < std::min<std::ptrdiff_t>(i, f.pivot_count); ++k)
      if (const double l = made.lu[at(i * n + k)]; l != 0) subtract(m, l, top + k * m, place(i));
}

void Propagation::back_substitute(int index, std::ptrdiff_t m, std::vector<double>& z) const {
  const Front& f = plan_.fronts[at(index)];
  const std::vector<double>& lu = factors_.made(at(index)).lu;
  const std::ptrdiff_t n = f.columns();
  double* const top = z.data() + f.first_unknown * m;
  for (std::ptrdiff_t i = f.pivot_count - 1; i >= 0; --i) {
    for (std::ptrdiff_t k = i + 1; k < f.pivot_count; ++k)
      subtract(m, lu[at(i * n + k)], top + k * m, top + i * m);
    for (std::ptrdiff_t j = 0; j < m; ++j) top[i * m + j] /= lu[at(i * n + i)];
  }
}

void Propagation::activate(std::span<const int> row_groups, std::span<const double> rhs,
                           std::ptrdiff_t m, Space& space) const {
  space.is_active.resize(plan_.fronts.size(), 0);
  space.active.clear();
  for (const int r : row_groups)
    for (int f = plan_.front_of_row[at(r)]; f >= 0 && !space.is_active[at(f)];
         f = plan_.fronts[at(f)].parent)
      space.is_active[at(f)] = 1, space.active.push_back(f);
  std::sort(space.active.begin(), space.active.end());
  for (const int f : space.active)
    for (const int r : plan_.list(plan_.fronts[at(f)].rows))
      std::fill_n(space.rows.data() + plan_.row_first[at(r)] * m,
                  plan_.structure.row_size[at(r)] * m, 0.0);
  const double* from = rhs.data();
  for (const int r : row_groups) {
    const std::ptrdiff_t count = plan_.structure.row_size[at(r)] * m;
    double* const to = space.rows.data() + plan_.row_first[at(r)] * m;
    for (std::ptrdiff_t i = 0; i < count; ++i) to[i] += from[i];
    from += count;
  }
}

void Propagation::solve(std::span<const int> row_groups, std::span<const double> rhs,
                        std::ptrdiff_t m, Space& space) const {
  space.z.assign(at(plan_.unknowns) * at(m), 0);
  space.rows.resize(at(plan_.unknowns) * at(m));
  space.carried.resize(at(plan_.carried) * at(m));
  activate(row_groups, rhs, m, space);
  for (const int f : space.active) forward(f, m, space);
  for (int i = static_cast<int>(plan_.fronts.size()) - 1; i >= 0; --i) {
    const Front& f = plan_.fronts[at(i)];
    if (space.is_active[at(i)]) back_substitute(i, m, space.z);
    const double* w = border_.data() + begin_[at(i)];
    const auto border = plan_.list(f.border);
    for (std::size_t b = 0; b < border.size();) {
      const int first = plan_.first[at(border[b])];
      int size = 0;  // of neighbours among the unknowns, taken together
      for (; b < border.size() && plan_.first[at(border[b])] == first + size; ++b)
        size += plan_.structure.variable_size[at(border[b])];
      multiply_add(f.pivot_count, size, m, w, f.border_count, space.z.data() + first * m,
                   space.z.data() + f.first_unknown * m);
      w += size;
    }
  }
  for (const int f : space.active) space.is_active[at(f)] = 0;
}

}  // namespace titop::solve
