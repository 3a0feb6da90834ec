#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>

/// Solving with the factors: leaf to root with the right-hand sides, root to leaf with the
/// unknowns.
namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The rows of a front, as they were assembled, then permuted and reduced by L. The first
/// pivot_count rows stay, the rest is carried to the parent.
template <class T>
struct Forward {
  const Plan& plan;
  std::ptrdiff_t m;  ///< columns
  RowMatrix<T>&z, carried;
  std::vector<const T*> assembled = {};  ///< where each row stands
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
      copy(1, assembled[at(made.order[at(i)])], rows.data() + i * m);
    const int n = f.columns();
    for (int i = 1; i < f.row_count; ++i)
      subtract_rows(std::min(i, f.pivot_count), made.lu.data() + i * n, rows.data(), m,
                    rows.data() + i * m);
    copy(f.pivot_count, rows.data(), z.data() + f.first_unknown * m);
    copy(f.left_over(), rows.data() + f.pivot_count * m, carried.data() + f.first_carried * m);
  }

  /// A single column is copied without asking the library for it.
  void copy(int count, const T* from, T* to) const {
    if (m != 1) return void(std::copy_n(from, count * m, to));
    for (int i = 0; i < count; ++i) to[i] = from[i];
  }
};

/// Pivots of a front from its border and U, in place.
template <class T>
void backward(const Plan& plan, const Front& f, const typename Factors<T>::Made& made,
              std::ptrdiff_t m, RowMatrix<T>& z) {
  const int n = f.columns();
  for (int i = f.pivot_count - 1; i >= 0; --i) {
    T* to = z.data() + (f.first_unknown + i) * m;
    const T* u = made.lu.data() + i * n + f.pivot_count;
    for (const int v : plan.list(f.border)) {
      const int size = plan.structure.variable_size[at(v)];
      subtract_rows(size, u, z.data() + plan.first[at(v)] * m, m, to);
      u += size;
    }
    subtract_rows(f.pivot_count - i - 1, made.lu.data() + i * n + i + 1,
                  z.data() + (f.first_unknown + i + 1) * m, m, to);
    const T& pivot = made.lu[at(i * n + i)];
    for (std::ptrdiff_t j = 0; j < m; ++j) to[j] /= pivot;
  }
}

}  // namespace

template <class T>
RowMatrix<T> Factors<T>::solve(const RowMatrix<T>& rhs) const {
  RowMatrix<T> z(plan_->unknowns, rhs.cols()), carried(plan_->carried, rhs.cols());
  Forward<T> forward{*plan_, rhs.cols(), z, carried};
  for (std::size_t i = 0; i < fronts_.size(); ++i) forward.run(plan_->fronts[i], *fronts_[i], rhs);
  for (std::size_t i = fronts_.size(); i-- > 0;)
    backward<T>(*plan_, plan_->fronts[i], *fronts_[i], rhs.cols(), z);
  return z;
}

#define TITOP_INSTANTIATE(T) template RowMatrix<T> Factors<T>::solve(const RowMatrix<T>&) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
