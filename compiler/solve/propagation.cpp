#include <algorithm>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

}  // namespace

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

/// The rows of a front as they come: nullptr where nothing has reached them yet.
void Propagation::gather(const Front& f, std::ptrdiff_t m, Space& space) const {
  space.come.assign(at(f.row_count), nullptr);
  std::size_t row = 0;
  for (const int r : plan_.list(f.rows)) {
    const int size = plan_.structure.row_size[at(r)];
    if (space.is_set[at(r)])
      for (int k = 0; k < size; ++k)
        space.come[row + at(k)] = space.rows.data() + (plan_.row_first[at(r)] + k) * m;
    row += at(size);
  }
  for (const int c : plan_.list(f.children)) {
    const Front& child = plan_.fronts[at(c)];
    if (space.is_active[at(c)])
      for (int k = 0; k < child.left_over(); ++k)
        if (space.is_carried[at(child.first_carried + k)])
          space.come[row + at(k)] = space.carried.data() + (child.first_carried + k) * m;
    row += at(child.left_over());
  }
}

/// L^-1 of the rows that are not zero.
void Propagation::forward(int index, std::ptrdiff_t m, Space& space) const {
  const Front& f = plan_.fronts[at(index)];
  const auto& made = factors_.made(at(index));
  gather(f, m, space);
  const std::ptrdiff_t n = f.columns();
  double* const top = space.z.data() + f.first_unknown * m;
  double* const rest = space.carried.data() + f.first_carried * m;
  std::vector<char>& full = space.full;
  full.assign(at(f.row_count), 0);
  for (std::ptrdiff_t i = 0; i < f.row_count; ++i) {
    double* const to = i < f.pivot_count ? top + i * m : rest + (i - f.pivot_count) * m;
    if (const double* from = space.come[at(made.order[at(i)])])
      std::copy_n(from, m, to), full[at(i)] = 1;
    for (std::ptrdiff_t k = 0; k < std::min<std::ptrdiff_t>(i, f.pivot_count); ++k) {
      const double l = made.lu[at(i * n + k)];
      if (l == 0 || !full[at(k)]) continue;
      if (!full[at(i)]) std::fill_n(to, m, 0.0);
      full[at(i)] = 1;
      subtract(m, l, top + k * m, to);
    }
    if (i >= f.pivot_count)
      space.is_carried[at(f.first_carried + i - f.pivot_count)] = full[at(i)];
    else if (!full[at(i)])
      std::fill_n(to, m, 0.0);
  }
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
  space.is_set.resize(plan_.structure.row_size.size(), 0);
  space.is_carried.resize(at(plan_.carried), 0);
  space.active.clear();
  for (const int r : row_groups)
    for (int f = plan_.front_of_row[at(r)]; f >= 0 && !space.is_active[at(f)];
         f = plan_.fronts[at(f)].parent)
      space.is_active[at(f)] = 1, space.active.push_back(f);
  std::sort(space.active.begin(), space.active.end());
  const double* from = rhs.data();
  for (const int r : row_groups) {
    const std::ptrdiff_t count = plan_.structure.row_size[at(r)] * m;
    double* const to = space.rows.data() + plan_.row_first[at(r)] * m;
    if (space.is_set[at(r)])
      for (std::ptrdiff_t i = 0; i < count; ++i) to[i] += from[i];
    else
      std::copy_n(from, count, to);
    space.is_set[at(r)] = 1;
    from += count;
  }
}

void Propagation::solve(std::span<const int> row_groups, std::span<const double> rhs,
                        std::ptrdiff_t m, Space& space) const {
  space.z.resize(at(plan_.unknowns) * at(m));
  space.rows.resize(at(plan_.unknowns) * at(m));
  space.carried.resize(at(plan_.carried) * at(m));
  activate(row_groups, rhs, m, space);
  for (const int f : space.active) forward(f, m, space);
  for (int i = static_cast<int>(plan_.fronts.size()) - 1; i >= 0; --i) {
    const Front& f = plan_.fronts[at(i)];
    bool add = space.is_active[at(i)];  // otherwise nothing stands there yet
    if (add) back_substitute(i, m, space.z);
    double* const top = space.z.data() + f.first_unknown * m;
    if (!add && f.border_count == 0) std::fill_n(top, f.pivot_count * m, 0.0);
    const double* w = border_.data() + begin_[at(i)];
    const auto border = plan_.list(f.border);
    for (std::size_t b = 0; b < border.size();) {
      const int first = plan_.first[at(border[b])];
      int size = 0;  // of neighbours among the unknowns, taken together
      for (; b < border.size() && plan_.first[at(border[b])] == first + size; ++b)
        size += plan_.structure.variable_size[at(border[b])];
      multiply(f.pivot_count, size, m, w, f.border_count, space.z.data() + first * m, top, add);
      add = true;
      w += size;
    }
  }
  for (const int f : space.active) space.is_active[at(f)] = 0;
  for (const int r : row_groups) space.is_set[at(r)] = 0;
}

}  // namespace titop::solve
