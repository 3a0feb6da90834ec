#include <algorithm>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

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
    FrontPlace p{padded(f.pivot_count), f.border_count + f.pivot_count, total};
    p.unknowns = p.lower + at(f.row_count * p.by_pivots);
    total = p.unknowns + at(f.pivot_count * p.by_all);
    place_.push_back(p);
  }
  grow(formed_, total);
  column_.resize(at(plan_.unknowns));
}

void Propagation::form(int k, int parts) {
  const std::size_t fronts = plan_.fronts.size(), end = fronts * at(k + 1) / at(parts);
  for (std::size_t i = fronts * at(k) / at(parts); i < end; ++i) form_front(i);
}

/// Columns of L^-1 for the pivots' rows: rows from children are first. Above the front of a
/// right-hand side the others are 0.
void Propagation::order_columns(std::size_t index) {
  const Front& f = plan_.fronts[index];
  int entered = 0, next = 0;
  for (const int r : plan_.list(f.rows)) entered += plan_.structure.row_size[at(r)];
  const auto rows = factors_.made(index).order.first(at(f.pivot_count));
  int* const column = column_.data() + f.first_unknown;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] >= entered) column[k] = next++;
  place_[index].carried = next;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] < entered) column[k] = next++;
}

void Propagation::form_front(std::size_t index) {
  order_columns(index);
  const Front& f = plan_.fronts[index];
  const FrontPlace& p = place_[index];
  const double* const lu = factors_.made(index).lu.data();
  const std::ptrdiff_t n = f.columns(), pivots = f.pivot_count, border = f.border_count;
  const int* const column = column_.data() + f.first_unknown;
  double* const lower = formed_.data() + p.lower;
  std::fill_n(lower, f.row_count * p.by_pivots, 0.0);
  for (std::ptrdiff_t r = 0; r < pivots; ++r) lower[r * p.by_pivots + column[r]] = 1;
  substitute_lower(f.row_count, pivots, p.by_pivots, lu, n, lower);
  double* row = formed_.data() + p.unknowns;
  for (std::ptrdiff_t r = 0; r < pivots; ++r, row += p.by_all) {
    for (std::ptrdiff_t j = 0; j < border; ++j) row[j] = -lu[r * n + pivots + j];
    std::copy_n(lower + r * p.by_pivots, pivots, row + border);
  }
}

/// The rows of a front as they come: nullptr if nothing has reached them yet.
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

/// The contributions of the front's rows to its parent. Those of its pivots are kept for back
/// substitution.
void Propagation::forward(int index, Space& space) const {
  const std::ptrdiff_t m = space.m;
  const Front& f = plan_.fronts[at(index)];
  const FrontPlace& p = place_[at(index)];
  const auto& order = factors_.made(at(index)).order;
  const int* const column = column_.data() + f.first_unknown;
  const double* const zeros = space.zeros.data();
  const double** const with = space.pivots.data() + f.first_unknown;
  gather(f, space);
  int used = 0;
  for (int k = 0; k < f.pivot_count; ++k) {
    const double* const come = space.come[at(order[at(k)])];
    if (come) used = std::max(used, column[k] < p.carried ? p.carried : f.pivot_count);
    with[column[k]] = come ? come : zeros;
  }
  space.used[at(index)] = used;
  space.from.clear();
  for (const int place : order.subspan(at(f.pivot_count))) {
    const double* const come = space.come[at(place)];
    space.is_carried[at(f.first_carried) + space.from.size()] = used > 0 || come;
    space.from.push_back(come ? come : zeros);
  }
  multiply(f.left_over(), used, m, formed_.data() + p.lower + at(f.pivot_count * p.by_pivots),
           p.by_pivots, with, space.from.data(), space.carried.data() + f.first_carried * m, m);
}

/// The front's unknowns from those of its border and, if it is active, its own rows.
void Propagation::back(int index, Space& space) const {
  const std::ptrdiff_t m = space.m;
  const Front& f = plan_.fronts[at(index)];
  const FrontPlace& p = place_[at(index)];
  double* const top = space.z.data() + f.first_unknown * m;
  space.with.clear();
  for (const int v : plan_.list(f.border))
    for (int i = 0; i < plan_.structure.variable_size[at(v)]; ++i)
      space.with.push_back(space.z.data() + (plan_.first[at(v)] + i) * m);
  if (const int used = space.is_active[at(index)] ? space.used[at(index)] : 0; used > 0) {
    const double* const* const own = space.pivots.data() + f.first_unknown;
    space.with.insert(space.with.end(), own, own + used);
  }
  multiply(f.pivot_count, static_cast<std::ptrdiff_t>(space.with.size()), m,
           formed_.data() + p.unknowns, p.by_all, space.with.data(), nullptr, top, m);
  substitute_upper(f.pivot_count, m, factors_.made(at(index)).lu.data(), f.columns(), top);
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
  space.pivots.resize(at(plan_.unknowns));
  space.used.resize(plan_.fronts.size());
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
  for (int i = static_cast<int>(plan_.fronts.size()) - 1; i >= 0; --i) back(i, space);
}

}  // namespace titop::solve
