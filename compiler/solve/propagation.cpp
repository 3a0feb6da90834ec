#include <algorithm>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

std::ptrdiff_t padded(std::ptrdiff_t columns) { return (columns + 7) / 8 * 8; }

/// Room that is there is not cleared again.
void grow(std::vector<double>& room, std::size_t size) {
  if (room.size() < size) room.resize(size);
}

}  // namespace

Propagation::Propagation(const Factors<double>& factors, std::vector<double>& room)
    : factors_(factors), plan_(factors.plan()), formed_(room) {
  std::size_t total = 0;
  place_.reserve(plan_.fronts.size());
  for (const Front& f : plan_.fronts) {
    Place p{padded(f.pivot_count), padded(f.border_count), total, 0, 0};
    p.carry = p.own + at(f.pivot_count * p.by_pivots);
    p.border = p.carry + at(f.left_over() * p.by_pivots);
    total = p.border + at(f.pivot_count * p.by_border);
    place_.push_back(p);
  }
  grow(formed_, total);
}

void Propagation::form() {
  for (std::size_t i = 0; i < plan_.fronts.size(); ++i) form(i);
}

/// `carry` stands below `own` and comes of the same substitution.
void Propagation::form(std::size_t index) {
  const Front& f = plan_.fronts[index];
  const Place& p = place_[index];
  const double* const lu = factors_.made(index).lu.data();
  const std::ptrdiff_t n = f.columns(), pivots = f.pivot_count;
  double* const own = formed_.data() + p.own;
  std::fill_n(own, f.row_count * p.by_pivots, 0.0);
  for (std::ptrdiff_t r = 0; r < pivots; ++r) own[r * p.by_pivots + r] = 1;
  substitute_lower(f.row_count, pivots, p.by_pivots, lu, n, own);
  substitute_upper(pivots, p.by_pivots, lu, n, own);
  double* const border = formed_.data() + p.border;
  std::fill_n(border, pivots * p.by_border, 0.0);
  for (std::ptrdiff_t r = 0; r < pivots; ++r)
    for (std::ptrdiff_t j = 0; j < f.border_count; ++j)
      border[r * p.by_border + j] = -lu[r * n + pivots + j];
  substitute_upper(pivots, p.by_border, lu, n, border);
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

/// What the front's rows give to its unknowns and carry upwards.
void Propagation::forward(int index, std::ptrdiff_t m, Space& space) const {
  const Front& f = plan_.fronts[at(index)];
  const auto& order = factors_.made(at(index)).order;
  gather(f, m, space);
  bool any = false;
  double* const r = space.pivot_rows.data();
  for (std::ptrdiff_t i = 0; i < f.pivot_count; ++i) {
    const double* from = space.come[at(order[at(i)])];
    any = any || from;
    from ? std::copy_n(from, m, r + i * m) : std::fill_n(r + i * m, m, 0.0);
  }
  double* const top = space.z.data() + f.first_unknown * m;
  double* const rest = space.carried.data() + f.first_carried * m;
  for (std::ptrdiff_t i = f.pivot_count; i < f.row_count; ++i) {
    double* const to = rest + (i - f.pivot_count) * m;
    const double* from = space.come[at(order[at(i)])];
    from ? std::copy_n(from, m, to) : std::fill_n(to, m, 0.0);
    space.is_carried[at(f.first_carried + i - f.pivot_count)] = any || from;
  }
  if (!any) {
    std::fill_n(top, f.pivot_count * m, 0.0);
    return;
  }
  const Place& p = place_[at(index)];
  const std::ptrdiff_t n = f.pivot_count;
  multiply(f.left_over(), n, m, formed_.data() + p.carry, p.by_pivots, r, rest, true);
  if (n > 1) return multiply(n, n, m, formed_.data() + p.own, p.by_pivots, r, top, false);
  // A division rounds once, a product with the inverse twice.
  const double pivot = factors_.made(at(index)).lu.front();
  for (std::ptrdiff_t j = 0; j < m; ++j) top[j] = r[j] / pivot;
}

/// The front's unknowns from those of its border; `add`: something stands there already.
void Propagation::add_border(int index, std::ptrdiff_t m, bool add, std::vector<double>& z) const {
  const Front& f = plan_.fronts[at(index)];
  double* const top = z.data() + f.first_unknown * m;
  if (!add && f.border_count == 0) std::fill_n(top, f.pivot_count * m, 0.0);
  const Place& p = place_[at(index)];
  const double* w = formed_.data() + p.border;
  const auto border = plan_.list(f.border);
  for (std::size_t b = 0; b < border.size();) {
    const int first = plan_.first[at(border[b])];
    int size = 0;  // of neighbours among the unknowns, taken together
    for (; b < border.size() && plan_.first[at(border[b])] == first + size; ++b)
      size += plan_.structure.variable_size[at(border[b])];
    multiply(f.pivot_count, size, m, w, p.by_border, z.data() + first * m, top, add);
    add = true;
    w += size;
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
  grow(space.z, at(plan_.unknowns) * at(m));
  grow(space.rows, at(plan_.unknowns) * at(m));
  grow(space.carried, at(plan_.carried) * at(m));
  activate(row_groups, rhs, m, space);
  std::size_t most = 0;
  for (const int f : space.active) most = std::max(most, at(plan_.fronts[at(f)].pivot_count));
  grow(space.pivot_rows, most * at(m));
  for (const int f : space.active) forward(f, m, space);
  for (int i = static_cast<int>(plan_.fronts.size()) - 1; i >= 0; --i)
    add_border(i, m, space.is_active[at(i)], space.z);
  for (const int f : space.active) space.is_active[at(f)] = 0;
  for (const int r : row_groups) space.is_set[at(r)] = 0;
}

}  // namespace titop::solve
