#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/scaling.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Adds the rows that a child front left over; their `keeps` go along.
template <class T>
void add_child(const Plan& plan, const Front& child, const typename Factors<T>::Made& made,
               T* at_row, std::ptrdiff_t stride) {
  const std::ptrdiff_t columns = child.columns();
  for (int i = child.pivot_count; i < child.row_count; ++i, at_row += stride) {
    const T* from = made.lu.data() + i * columns + child.pivot_count;
    for (int k = child.border.begin; k < child.border.begin + child.border.count; ++k) {
      const int size = plan.structure.variable_size[at(plan.lists[at(k)])];
      std::copy(from, from + size, at_row + plan.parent_column[at(k)]);
      from += size;
    }
  }
}

/// The work on one front. `bound` carries the sums of magnitudes that formed each entry: a pivot
/// far below its bound is what cancellation has left. `keeps` says so of whole rows, from front to
/// front: a row of which only rounding is left must not pass for a good one further up.
template <class T>
struct Work {
  const Front& front;
  typename Factors<T>::Made& m;
  std::ptrdiff_t n;               ///< columns
  std::vector<double> bound;      ///< as m.lu
  std::vector<double> keeps;      ///< per row
  std::vector<double> row_scale;  ///< per row: its size, the columns having been given the same

  Work(const Front& f, typename Factors<T>::Made& made)
      : front(f), m(made), n(f.columns()), keeps(at(f.row_count), 1) {
    m.lu.assign(at(front.row_count) * at(front.columns()), T(0));
    m.order.resize(at(front.row_count));
    for (int i = 0; i < front.row_count; ++i) m.order[at(i)] = i;
  }

  T* row(int i) { return m.lu.data() + i * n; }
  double* bounds(int i) { return bound.data() + i * n; }

  double largest() const {
    double result = 0;
    for (const T& x : m.lu) result = std::max(result, size_of(x));
    return result;
  }

  void start() {
    bound.resize(m.lu.size());
    for (std::size_t i = 0; i < m.lu.size(); ++i) bound[i] = size_of(m.lu[i]);
    for (int i = 0; i < front.row_count; ++i)
      if (keeps[at(i)] != 1)
        for (std::ptrdiff_t j = 0; j < n; ++j) bounds(i)[j] /= keeps[at(i)];
  }

  void scale_rows(const std::vector<std::int16_t>& columns) {
    std::vector<double> factor(columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) factor[j] = std::ldexp(1.0, columns[j]);
    row_scale.assign(at(front.row_count), 0);
    for (int i = 0; i < front.row_count; ++i)
      for (std::ptrdiff_t j = 0; j < n; ++j)
        row_scale[at(i)] =
            std::max(row_scale[at(i)], bounds(i)[j] * factor[static_cast<std::size_t>(j)]);
  }

  /// The pivot of a column is the row where it stands out most against the row's own size: the
  /// choice depends neither on the rows' units nor on the columns'. -1 if no digit is left.
  int pivot(int k) {
    int best = -1;
    double best_score = 0, left = 0;
    for (int i = k; i < front.row_count; ++i) {
      const double size = size_of(row(i)[k]), from = bounds(i)[k];
      const double score = row_scale[at(i)] > 0 ? size / row_scale[at(i)] : 0;
      if (score > best_score) best_score = score, best = i;
      // What a column keeps after cancellation, over all its rows: invariant under any scaling.
      if (from > 0) left = std::max(left, size / from);
    }
    if (left < m.weakest) m.weakest = left, m.weakest_column = k;
    return left < 4 * Scalar<T>::epsilon() || !std::isfinite(best_score) ? -1 : best;
  }

  void swap(int a, int b) {
    if (a == b) return;
    std::swap_ranges(row(a), row(a) + n, row(b));
    std::swap_ranges(bounds(a), bounds(a) + n, bounds(b));
    std::swap(row_scale[at(a)], row_scale[at(b)]);
    std::swap(m.order[at(a)], m.order[at(b)]);
  }

  void eliminate(int k) {
    const std::ptrdiff_t right = n - k - 1;
    const T* from = row(k) + k;
    for (int i = k + 1; i < front.row_count; ++i) {
      T* to = row(i) + k;
      if (to[0] == T(0)) continue;
      const T l = to[0] / from[0];
      to[0] = l;
      subtract(right, l, from + 1, to + 1);
      add(right, size_of(l), bounds(k) + k + 1, bounds(i) + k + 1);
    }
  }

  /// Largest share that cancellation has left of a row left over; 1 unless it is little: ordinary
  /// losses are not to add up along a long chain.
  double kept(int i) {
    double share = 0;
    for (std::ptrdiff_t j = front.pivot_count; j < n; ++j)
      if (bounds(i)[j] > 0) share = std::max(share, size_of(row(i)[j]) / bounds(i)[j]);
    return share > 1e-6 || share == 0 ? 1 : share;
  }
};

}  // namespace

template <class T>
void Factors<T>::make(int index, const Rows<T>& rows, ColumnScale* found) {
  const Front& front = plan_->fronts[at(index)];
  auto made = std::make_shared<Made>();
  Work<T> w(front, *made);
  int row = 0;
  for (const int r : plan_->list(front.rows)) {
    rows.add(r, w.row(row), w.n, plan_->entry_column.data() + plan_->structure.row_begin[at(r)]);
    row += plan_->structure.row_size[at(r)];
  }
  for (const int c : plan_->list(front.children)) {
    const Front& child = plan_->fronts[at(c)];
    add_child<T>(*plan_, child, *fronts_[at(c)], w.row(row), w.n);
    std::copy(fronts_[at(c)]->keeps.begin(), fronts_[at(c)]->keeps.end(), w.keeps.begin() + row);
    row += child.left_over();
  }
  const double start = w.largest();
  w.start();
  if (found) (*found)[at(index)] = column_scale(w.bound.data(), front.row_count, front.columns());
  w.scale_rows((*scale_)[at(index)]);
  for (int k = 0; k < front.pivot_count && !made->singular; ++k) {
    const int best = w.pivot(k);
    made->singular = best < 0;
    if (made->singular) break;
    w.swap(k, best);
    w.eliminate(k);
  }
  for (int i = front.pivot_count; i < front.row_count; ++i) made->keeps.push_back(w.kept(i));
  if (start > 0) made->growth = w.largest() / start;
  fronts_[at(index)] = std::move(made);
  ++made_;
}

template <class T>
Factors<T>::Factors(std::shared_ptr<const Plan> plan, const Rows<T>& rows,
                    std::shared_ptr<const ColumnScale> scale)
    : plan_(std::move(plan)), scale_(std::move(scale)), fronts_(plan_->fronts.size()) {
  std::shared_ptr<ColumnScale> found;
  if (!scale_) scale_ = found = std::make_shared<ColumnScale>(fronts_.size());
  for (int i = 0; i < static_cast<int>(fronts_.size()) && singular_ < 0; ++i) {
    make(i, rows, found.get());
    if (fronts_[at(i)]->singular) singular_ = i;
  }
}

template <class T>
Factors<T> Factors<T>::changed(const Rows<T>& rows, std::span<const int> row_groups) const {
  Factors result(*this);
  result.made_ = 0;
  std::vector<char> todo(fronts_.size(), 0);
  for (const int r : row_groups)
    for (int f = plan_->front_of_row[at(r)]; f >= 0 && !todo[at(f)];
         f = plan_->fronts[at(f)].parent)
      todo[at(f)] = 1;
  for (int f = 0; f < static_cast<int>(fronts_.size()) && result.singular_ < 0; ++f) {
    if (!todo[at(f)]) continue;
    result.make(f, rows, nullptr);
    if (result.fronts_[at(f)]->singular) result.singular_ = f;
  }
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
  h.singular_variables.assign(pivots.begin(), pivots.end());
  return h;
}

template class Factors<double>;
#define TITOP_INSTANTIATE(T) template class Factors<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
