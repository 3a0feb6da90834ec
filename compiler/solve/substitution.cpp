#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

/// Solving with the factors: leaf to root with the right-hand sides, root to leaf with the
/// unknowns.
namespace titop::solve {
namespace {

using linalg::at;

/// The rows of a front, as they were assembled, then permuted and reduced by L. The first
/// pivot_count rows remain, the rest is carried to the parent.
template <class T>
struct Forward {
  const Plan& plan;
  std::ptrdiff_t m;  ///< columns
  RowMatrix<T>&z, carried;
  std::vector<const T*> assembled = {};  ///< address of each row
  std::vector<T> rows = {};

  void run(const Front& f, const typename Factors<T>::Made& made, const RowMatrix<T>& rhs) {
    assembled.clear();
    const auto take = [&](const T* from, int count) {
      for (int i = 0; i < count; ++i) assembled.push_back(from + i * m);
    };
    for (const int r : plan.list(f.rows))
      take(rhs.data() + plan.row_first[at(r)] * m, plan.structure.row_size[at(r)]);
    for (const int c : plan.list(f.children)) {
      const Front& child = plan.fronts[at(c)];
      take(carried.data() + child.first_carried * m, child.left_over());
    }
    rows.resize(assembled.size() * static_cast<std::size_t>(m));
    for (int i = 0; i < f.row_count; ++i)
      std::copy_n(assembled[at(made.order[at(i)])], m, rows.data() + i * m);
    const std::ptrdiff_t n = f.columns();
    for (int i = 1; i < f.row_count; ++i)
      subtract_rows(std::min(i, f.pivot_count), made.lu.data() + i * n, rows.data(), m,
                    rows.data() + i * m);
    std::copy_n(rows.data(), f.pivot_count * m, z.data() + f.first_unknown * m);
    std::copy_n(rows.data() + f.pivot_count * m, f.left_over() * m,
                carried.data() + f.first_carried * m);
  }
};

/// The same for a single column, whose numbers are copied at once; `rows`: room for as many.
template <class T>
void forward_one(const Plan& plan, const Front& f, const typename Factors<T>::Made& made,
                 const T* rhs, T* z, T* carried, T* rows) {
  T* end = rows;
  const int* const size = plan.structure.row_size.data();
  const int* const first = plan.row_first.data();
  for (const int r : plan.list(f.rows)) {
    const T* const from = rhs + first[r];
    *end++ = from[0];  // most rows of scalar diagrams are one
    for (int i = 1; i < size[r]; ++i) *end++ = from[i];
  }
  for (const int c : plan.list(f.children)) {
    const Front& child = plan.fronts[at(c)];
    const T* const from = carried + child.first_carried;
    for (int i = 0; i < child.left_over(); ++i) *end++ = from[i];
  }
  T* const pivots = z + f.first_unknown;
  T* const left = carried + f.first_carried;
  const int* const order = made.order.data();
  const T* l = made.lu.data();
  const int columns = f.columns();
  pivots[0] = rows[order[0]];
  for (int i = 1; i < f.row_count; ++i) {
    T sum = rows[order[i]];
    l += columns;
    if (f.pivot_count == 1)  // as most fronts of scalar diagrams
      subtract_rows(1, l, pivots, 1, &sum);
    else
      subtract_rows(std::min(i, f.pivot_count), l, pivots, 1, &sum);
    (i < f.pivot_count ? pivots[i] : left[i - f.pivot_count]) = sum;
  }
}

/// Pivots of a front from its border and U, in place.
template <class T>
void backward(const Plan& plan, const Front& f, const typename Factors<T>::Made& made,
              std::ptrdiff_t m, T* z) {
  T* const pivots = z + f.first_unknown * m;
  for (int i = f.pivot_count - 1; i >= 0; --i) {
    T* to = pivots + i * m;
    const T* row = made.lu.data() + std::ptrdiff_t{i} * f.columns();
    const T* u = row + f.pivot_count;
    for (const int v : plan.list(f.border)) {
      const int size = plan.structure.variable_size[at(v)];
      const T* x = z + plan.first[at(v)] * m;
      size == 1 ? subtract_rows(1, u, x, m, to) : subtract_rows(size, u, x, m, to);
      u += size;
    }
    if (i + 1 < f.pivot_count) subtract_rows(f.pivot_count - i - 1, row + i + 1, to + m, m, to);
    const Divisor<T> over(row[i]);
    for (std::ptrdiff_t j = 0; j < m; ++j) to[j] = over(to[j]);
  }
}

/// Prefetches the numbers of the next front: they are scattered in memory for many fronts, and most
/// of a solution's time is waiting for them. Of a wide front only the beginning: the processor
/// prefetches the rest.
template <class T>
void fetch(const typename Factors<T>::Made& made) {
  constexpr std::size_t kLine = 64, kMost = 8192;
  const auto* const from = reinterpret_cast<const char*>(made.lu.data());
  const std::size_t bytes = std::min(made.lu.size() * sizeof(T), kMost);
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(from + i);
  __builtin_prefetch(made.order.data());
}

}  // namespace

template <class T>
RowMatrix<T> Factors<T>::solve(const RowMatrix<T>& rhs) const {
  const Plan& plan = *plan_;
  const std::ptrdiff_t m = rhs.cols();
  auto z = unwritten<T>(plan.unknowns, m), carried = unwritten<T>(plan.carried, m);
  if (m == 1) {
    RowMatrix<T> rows(plan.unknowns, 1);  // of one front: never more
    const std::size_t count = fronts_.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (i + 1 < count) fetch<T>(*fronts_[i + 1]);
      forward_one(plan, plan.fronts[i], *fronts_[i], rhs.data(), z.data(), carried.data(),
                  rows.data());
    }
    for (std::size_t i = count; i-- > 0;) {
      if (i > 0) fetch<T>(*fronts_[i - 1]);
      backward(plan, plan.fronts[i], *fronts_[i], 1, z.data());  // 1 is known to the compiler
    }
    return z;
  }
  Forward<T> forward{plan, m, z, carried};
  for (std::size_t i = 0; i < fronts_.size(); ++i) forward.run(plan.fronts[i], *fronts_[i], rhs);
  for (std::size_t i = fronts_.size(); i-- > 0;)
    backward(plan, plan.fronts[i], *fronts_[i], m, z.data());
  return z;
}

#define TITOP_INSTANTIATE(T) template RowMatrix<T> Factors<T>::solve(const RowMatrix<T>&) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
