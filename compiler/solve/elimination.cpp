#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/equilibration.hpp>
#include <titop/compiler/solve/front_elimination.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/scaling.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

/// Adds the rows that a child front left over; their `keeps` go along.
template <class T>
void add_child(const Plan& plan, const Front& child, const typename Factors<T>::Made& made,
               T* at_row, std::ptrdiff_t stride) {
  const std::ptrdiff_t columns = child.columns();
  for (int i = child.pivot_count; i < child.row_count; ++i, at_row += stride) {
    const T* from = made.lu.data() + i * columns + child.pivot_count;
    for (int k = child.border.begin; k < child.border.begin + child.border.count; ++k) {
      const int size = plan.structure.variable_size[at(plan.lists[at(k)])];
      T* const to = at_row + plan.parent_column[at(k)];
      if (size == 6)  // most of them: no call
        std::copy_n(from, 6, to);
      else
        std::copy_n(from, size, to);
      from += size;
    }
  }
}

/// Steps of elimination that are done in their own columns first, in all others then: a front is
/// traversed once for this many steps.
constexpr int kPanel = 32;
/// Fewer are done in all columns at once.
constexpr int kFewSteps = 16;

/// 2^e for the exponents of ColumnScale, from the bits: std::ldexp costs more than the rest.
double power_of_two(std::int16_t e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52);
}

}  // namespace

/// The work on one front, its buffers kept from front to front. `bound` has the sums of magnitudes
/// of the terms of each entry: a pivot far below its bound has cancelled. `keeps` records this for
/// whole rows, from front to front: further up, a row at rounding level must not be accepted as a
/// pivot row.
template <class T>
struct Factors<T>::Work {
  double least;                          ///< least ratio of a pivot to its terms
  std::vector<double> column_size = {};  ///< of the entries where a pivot is looked for
  std::vector<double> bound = {};        ///< as Made::lu
  std::vector<double> keeps = {};        ///< per row
  std::vector<double> row_scale =
      {};                           ///< per row: its size, the columns having been given the same
  std::vector<double> column = {};  ///< the factors that do so
  std::vector<double> common = {};  ///< per column: its factor in all fronts
  /// Per row: the least size that it has had, by `common`; 0: it is new.
  std::vector<double> least_size = {};
  std::vector<int> units = {};
  Made* m = nullptr;
  T* lu = nullptr;       ///< data of made->lu
  int* order = nullptr;  ///< data of made->order
  int rows = 0, pivots = 0;
  std::ptrdiff_t n = 0;  ///< columns

  void begin(const Front& front, Lot& lot, Made& made) {
    m = &made, rows = front.row_count, pivots = front.pivot_count, n = front.columns();
    lu = lot.entries.data() + (made.lu.data() - lot.entries.data());
    order = lot.rows.data() + (made.order.data() - lot.rows.data());
    std::fill_n(lu, made.lu.size(), T(0));
    std::iota(order, order + rows, 0);
    keeps.assign(at(rows), 1);
    least_size.assign(at(rows), 0);
  }

  /// First columns of variables that share a unit, and the end.
  const std::vector<int>& units_of(const Plan& plan, const Front& front) {
    units.assign(1, 0);
    for (const auto range : {front.pivots, front.border})
      for (const int v : plan.list(range))
        for (int i = 0; i < plan.structure.variable_size[at(v)];
             i += plan.structure.variable_unit[at(v)])
          units.push_back(units.back() + plan.structure.variable_unit[at(v)]);
    return units;
  }

  T* row(int i) { return lu + i * n; }
  double* bounds(int i) { return bound.data() + i * n; }

  void take_common(const Plan& plan, const Front& front, const ColumnScale& scale) {
    common.clear();
    const auto take = [&](int first, int count) {
      for (int i = 0; i < count; ++i)
        common.push_back(power_of_two(scale.of_unknowns[at(first + i)]));
    };
    take(front.first_unknown, front.pivot_count);
    for (const int v : plan.list(front.border))
      take(plan.first[at(v)], plan.structure.variable_size[at(v)]);
  }

  /// Bounds of the assembled entries, and sizes of the rows.
  void take_bounds() {
    bound.resize(m->lu.size());
    sizes(static_cast<std::ptrdiff_t>(m->lu.size()), lu, bound.data());
    row_scale.resize(at(rows));
    largest_products(rows, n, bound.data(), common.data(), row_scale.data());
    for (int i = 0; i < rows; ++i)
      if (double& least_of_row = least_size[at(i)];
          least_of_row == 0 || row_scale[at(i)] < least_of_row)
        least_of_row = row_scale[at(i)];
    for (int i = 0; i < rows; ++i)
      if (keeps[at(i)] != 1)
        for (std::ptrdiff_t j = 0; j < n; ++j) bounds(i)[j] /= keeps[at(i)];
  }

  void scale_rows(const std::int16_t* exponents) {
    column.resize(static_cast<std::size_t>(n));
    for (std::ptrdiff_t j = 0; j < n; ++j)
      column[static_cast<std::size_t>(j)] = power_of_two(exponents[j]);
    largest_products(rows, n, bound.data(), column.data(), row_scale.data());
  }

  /// Pivot row of a column: the row where its entry is largest relative to the row's own size,
  /// among those whose multipliers make no row grow (kThreshold): the choice depends neither on the
  /// rows' units nor on the columns'. -1 if there is no digit.
  int pivot(int k) {
    int best = -1;
    double best_score = 0, left = 0, most = 0;
    column_size.resize(at(rows));
    for (int i = k; i < rows; ++i) {  // divisions only if something is larger than before
      const double size = column_size[at(i)] = size_of(row(i)[k]);
      if (least_size[at(i)] > 0 && size > most * least_size[at(i)]) most = size / least_size[at(i)];
    }
    for (int i = k; i < rows; ++i) {
      const double size = column_size[at(i)], from = bounds(i)[k], scale = row_scale[at(i)];
      if (scale > 0 && size > best_score * scale && size >= kThreshold * most * least_size[at(i)])
        best_score = size / scale, best = i;
      // Largest ratio to the terms in the column: invariant under any scaling.
      if (from > 0 && size > left * from) left = size / from;
    }
    if (left < m->weakest) m->weakest = left, m->weakest_column = k;
    return left < least || !std::isfinite(best_score) ? -1 : best;
  }

  /// The column has no pivot: the row with the smallest remainder gets one, of its own size. The
  /// column's remainder is rounding.
  int patch(int k) {
    int best = k;
    double fewest = std::numeric_limits<double>::infinity();
    for (int i = k; i < rows; ++i) {
      row(i)[k] = T(0);
      double left = 0;
      for (std::ptrdiff_t j = k + 1; j < n; ++j)
        if (row_scale[at(i)] > 0)
          left = std::max(
              left, size_of(row(i)[j]) * column[static_cast<std::size_t>(j)] / row_scale[at(i)]);
      if (left < fewest) fewest = left, best = i;
    }
    const double size = row_scale[at(best)] > 0 ? row_scale[at(best)] : 1;
    const double value = size / column[at(k)];
    row(best)[k] = lift<T>(value);
    bounds(best)[k] = value;
    m->patched.emplace_back(k, value);
    return best;
  }

  void judge_finite() {
    m->finite = std::isfinite(largest(static_cast<std::ptrdiff_t>(bound.size()), bound.data()));
    m->singular = m->singular || !m->finite;
  }

  /// Sets entries at rounding level in the rows below k to 0.
  void clean(int k) {
    for (std::ptrdiff_t e = (k + 1) * n; e < static_cast<std::ptrdiff_t>(m->lu.size()); ++e)
      if (T& x = lu[e]; e % n > k && size_of(x) <= least * bound[static_cast<std::size_t>(e)])
        x = T(0);
  }

  void swap(int a, int b) {
    if (a == b) return;
    std::swap_ranges(row(a), row(a) + n, row(b));
    std::swap_ranges(bounds(a), bounds(a) + n, bounds(b));
    std::swap(row_scale[at(a)], row_scale[at(b)]);
    std::swap(least_size[at(a)], least_size[at(b)]);
    std::swap(order[a], order[b]);
  }

  /// Takes pivots from column k up to `end`, in the columns up to `to`; returns how far it came.
  int steps(int k, int end, std::ptrdiff_t to, NoPivot no_pivot) {
    for (; k < end; ++k) {
      int best = pivot(k);
      if (best < 0 && no_pivot == NoPivot::patch) best = patch(k);
      m->singular = best < 0;
      if (m->singular) break;
      swap(k, best);
      eliminate_below(k, to, rows, n, lu, bound.data());
      if (no_pivot == NoPivot::patch) clean(k);
    }
    return k;
  }

  void eliminate(NoPivot no_pivot) {
    // A patch looks at whole rows.
    if (no_pivot == NoPivot::patch || pivots < kFewSteps) {
      steps(0, pivots, n, no_pivot);
      return;
    }
    for (int k = 0; k < pivots && !m->singular;) {
      const int first = k, end = std::min(k + kPanel, pivots);
      k = steps(first, end, end, no_pivot);
      if (!m->singular) eliminate_right(first, end, rows, n, lu, bound.data());
    }
  }

  /// Largest ratio of an entry of a remaining row to its terms; 1 if it is ordinary.
  double kept(int i) {
    double share = 0;
    for (std::ptrdiff_t j = pivots; j < n; ++j) {
      if (size_of(row(i)[j]) > kOrdinaryLoss * bounds(i)[j]) return 1;
      if (bounds(i)[j] > 0) share = std::max(share, size_of(row(i)[j]) / bounds(i)[j]);
    }
    return share == 0 ? 1 : share;
  }

  /// Made::keeps, which stays empty without cancellation; the growth of the rows.
  void finish(double* carried) {
    for (int i = pivots; i < rows; ++i)
      if (const double share = kept(i); share != 1) {
        m->keeps.resize(at(rows - pivots), 1);
        m->keeps[at(i - pivots)] = share;
      }
    sizes(static_cast<std::ptrdiff_t>(m->lu.size()), lu, bound.data());  // their work is done
    for (int i = 0; i < rows; ++i) {
      const std::ptrdiff_t j = std::min(i, pivots);
      double now = 0;
      largest_products(1, n - j, bounds(i) + j, common.data() + j, &now);
      if (now > m->growth * least_size[at(i)] && least_size[at(i)] > 0)
        m->growth = now / least_size[at(i)];
    }
    std::copy(least_size.begin() + pivots, least_size.end(), carried);
  }
};

template <class T>
void Factors<T>::assemble(const Front& front, const Rows<T>& rows, Work& w) const {
  int row = 0;
  for (const int r : plan_->list(front.rows)) {
    rows.add(r, w.row(row), w.n, plan_->entry_column.data() + plan_->structure.row_begin[at(r)]);
    row += plan_->structure.row_size[at(r)];
  }
  for (const int c : plan_->list(front.children)) {
    const Front& child = plan_->fronts[at(c)];
    const Made& made = *fronts_[at(c)];
    add_child<T>(*plan_, child, made, w.row(row), w.n);
    std::copy(made.keeps.begin(), made.keeps.end(), w.keeps.begin() + row);
    std::ranges::copy(made.least_size, w.least_size.begin() + row);
    row += child.left_over();
  }
}

template <class T>
void Factors<T>::make(Lot& lot, Made& made, const Rows<T>& rows, Work& w, ColumnScale* found) {
  const Front& front = plan_->fronts[at(made.front)];
  w.begin(front, lot, made);
  assemble(front, rows, w);
  w.take_common(*plan_, front, *scale_);
  w.take_bounds();
  if (found)
    column_scale(w.bound.data(), front.row_count, w.units_of(*plan_, front),
                 found->in_fronts.data() + front.first_column);
  w.scale_rows(scale_->in_fronts.data() + front.first_column);
  w.eliminate(no_pivot_);
  w.judge_finite();
  w.finish(lot.sizes.data() + (made.least_size.data() - lot.sizes.data()));
}

/// Up to the first that is singular.
template <class T>
void Factors<T>::make_all(std::span<const int> fronts, const Rows<T>& rows, ColumnScale* found) {
  const std::shared_ptr<Lot> lot = lot_of(fronts);
  lots_.push_back(lot);
  Work work{least_};
  made_ = 0;
  for (Made& made : lot->made) {
    make(*lot, made, rows, work, found);
    fronts_[at(made.front)] = &made;
    ++made_;
    if (!made.singular) continue;
    singular_ = made.front;
    break;
  }
}

template <class T>
Factors<T>::Factors(std::shared_ptr<const Plan> plan, const Rows<T>& rows,
                    std::shared_ptr<const ColumnScale> scale, NoPivot no_pivot, double least)
    : plan_(std::move(plan)),
      scale_(std::move(scale)),
      fronts_(plan_->fronts.size(), nullptr),
      no_pivot_(no_pivot),
      least_(std::max(least, kNothingLeft * Scalar<T>::epsilon())) {
  std::shared_ptr<ColumnScale> found;
  if (!scale_)
    scale_ = found = std::make_shared<ColumnScale>(std::vector<std::int16_t>(at(plan_->columns)),
                                                   equilibration(*plan_, rows));
  std::vector<int> all(fronts_.size());
  std::iota(all.begin(), all.end(), 0);
  make_all(all, rows, found.get());
}

template <class T>
Factors<T> Factors<T>::changed(const Rows<T>& rows, std::span<const int> row_groups,
                               bool rescale) const {
  Factors result(*this);
  result.made_ = 0;
  if (singular_ >= 0) return result;
  std::shared_ptr<ColumnScale> found;
  if (rescale) result.scale_ = found = std::make_shared<ColumnScale>(*scale_);
  std::vector<char> is_todo(fronts_.size(), 0);
  for (const int r : row_groups)
    for (int f = plan_->front_of_row[at(r)]; f >= 0 && !is_todo[at(f)];
         f = plan_->fronts[at(f)].parent)
      is_todo[at(f)] = 1;
  std::vector<int> todo;
  for (int f = 0; f < static_cast<int>(fronts_.size()); ++f)
    if (is_todo[at(f)]) todo.push_back(f);
  result.make_all(todo, rows, found.get());
  result.tidy();
  return result;
}

template <class T>
Health Factors<T>::health() const {
  Health h;
  for (int i = 0; i < static_cast<int>(fronts_.size()); ++i) {
    if (!fronts_[at(i)]) break;
    const Made& m = *fronts_[at(i)];
    h.growth = std::max(h.growth, m.growth);
    if (!(m.weakest < h.weakest)) continue;
    h.weakest = m.weakest;
    int end = 0;
    for (const int v : plan_->list(plan_->fronts[at(i)].pivots)) {
      h.weakest_variable = v;
      end += plan_->structure.variable_size[at(v)];
      if (end > m.weakest_column) break;
    }
  }
  if (singular_ < 0) return h;
  const auto pivots = plan_->list(plan_->fronts[at(singular_)].pivots);
  h.singular = true;
  h.finite = fronts_[at(singular_)]->finite;
  h.singular_variables.assign(pivots.begin(), pivots.end());
  return h;
}

/// The scalar row that entered as row `place` of a front, here or in a child.
template <class T>
int Factors<T>::original_row(int index, int place) const {
  const Front& front = plan_->fronts[at(index)];
  for (const int r : plan_->list(front.rows)) {
    if (place < plan_->structure.row_size[at(r)]) return plan_->row_first[at(r)] + place;
    place -= plan_->structure.row_size[at(r)];
  }
  for (const int c : plan_->list(front.children)) {
    const Front& child = plan_->fronts[at(c)];
    if (place < child.left_over())
      return original_row(c, fronts_[at(c)]->order[at(child.pivot_count + place)]);
    place -= child.left_over();
  }
  return -1;
}

template <class T>
std::vector<Patch> Factors<T>::patches() const {
  std::vector<Patch> result;
  for (int f = 0; f < static_cast<int>(fronts_.size()); ++f)
    for (const auto& [column, value] : fronts_[at(f)]->patched)
      result.push_back({original_row(f, fronts_[at(f)]->order[at(column)]),
                        plan_->fronts[at(f)].first_unknown + column, value});
  return result;
}

template class Factors<double>;
#define TITOP_INSTANTIATE(T) template class Factors<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
