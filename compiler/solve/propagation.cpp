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
void Propagation::gather(const Front& f, Space& space) const {
  const std::ptrdiff_t m = space.m;
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
void Propagation::forward(int index, Space& space) const {
  const std::ptrdiff_t m = space.m;
  const Front& f = plan_.fronts[at(index)];
  const auto& order = factors_.made(at(index)).order;
  const double* const zeros = space.zeros.data();
  gather(f, space);
  bool any = false;
  space.with.clear();
  for (const int place : order.first(at(f.pivot_count))) {
    const double* const come = space.come[at(place)];
    any = any || come;
    space.with.push_back(come ? come : zeros);
  }
  space.from.clear();
  for (const int place : order.subspan(at(f.pivot_count))) {
    const double* const come = space.come[at(place)];
    space.is_carried[at(f.first_carried) + space.from.size()] = any || come;
    space.from.push_back(come ? come : zeros);
  }
  double* const top = space.z.data() + f.first_unknown * m;
  double* const rest = space.carried.data() + f.first_carried * m;
  const Place& p = place_[at(index)];
  const std::ptrdiff_t n = f.pivot_count, used = any ? n : 0;
  multiply(f.left_over(), used, m, formed_.data() + p.carry, p.by_pivots, space.with.data(),
           space.from.data(), rest);
  if (n == 1 && any) {
    // A division rounds once, a product with the inverse twice.
    const double pivot = factors_.made(at(index)).lu.front();
    for (std::ptrdiff_t j = 0; j < m; ++j) top[j] = space.with.front()[j] / pivot;
    return;
  }
  space.from.assign(at(n), zeros);
  multiply(n, used, m, formed_.data() + p.own, p.by_pivots, space.with.data(), space.from.data(),
           top);
}

/// The front's unknowns from those of its border; `add`: something stands there already.
void Propagation::add_border(int index, bool add, Space& space) const {
  const std::ptrdiff_t m = space.m;
  const Front& f = plan_.fronts[at(index)];
  double* const top = space.z.data() + f.first_unknown * m;
  space.with.clear();
  for (const int v : plan_.list(f.border))
    for (int i = 0; i < plan_.structure.variable_size[at(v)]; ++i)
      space.with.push_back(space.z.data() + (plan_.first[at(v)] + i) * m);
  space.from.clear();
  for (std::ptrdiff_t i = 0; i < f.pivot_count; ++i)
    space.from.push_back(add ? top + i * m : space.zeros.data());
  const Place& p = place_[at(index)];
  multiply(f.pivot_count, f.border_count, m, formed_.data() + p.border, p.by_border,
           space.with.data(), space.from.data(), top);
}

void Propagation::begin(std::ptrdiff_t m, Space& space) const {
  space.m = m;
  grow(space.z, at(plan_.unknowns) * at(m));
  grow(space.rows, at(plan_.unknowns) * at(m));
  grow(space.carried, at(plan_.carried) * at(m));
  space.zeros.assign(at(m), 0);
  space.set.clear();
  space.is_set.assign(plan_.structure.row_size.size(), 0);
  space.is_active.assign(plan_.fronts.size(), 0);
  space.is_carried.resize(at(plan_.carried), 0);
}

double* Propagation::rhs(int row_group, Space& space) const {
  double* const rows = space.rows.data() + plan_.row_first[at(row_group)] * space.m;
  if (space.is_set[at(row_group)]) return rows;
  space.is_set[at(row_group)] = 1;
  space.set.push_back(row_group);
  std::fill_n(rows, plan_.structure.row_size[at(row_group)] * space.m, 0.0);
  return rows;
}

void Propagation::activate(Space& space) const {
  space.active.clear();
  for (const int r : space.set)
    for (int f = plan_.front_of_row[at(r)]; f >= 0 && !space.is_active[at(f)];
         f = plan_.fronts[at(f)].parent)
      space.is_active[at(f)] = 1, space.active.push_back(f);
  std::sort(space.active.begin(), space.active.end());
}

void Propagation::solve(Space& space) const {
  activate(space);
  for (const int f : space.active) forward(f, space);
  for (int i = static_cast<int>(plan_.fronts.size()) - 1; i >= 0; --i)
    add_border(i, space.is_active[at(i)], space);
}

}  // namespace titop::solve
