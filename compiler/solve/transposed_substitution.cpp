#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

/// Solving with the transposed factors: leaf to root by U', root to leaf by L'.
namespace titop::solve {
namespace {

using linalg::at;

/// Divides the right-hand sides of a front's pivots by U', in place, and subtracts their effect on
/// those of its border.
template <class T>
void transposed_upper(const Plan& plan, const Front& f, const typename Factors<T>::Made& made,
                      std::ptrdiff_t m, T* g) {
  T* const pivots = g + f.first_unknown * m;
  for (int i = 0; i < f.pivot_count; ++i) {
    const T* row = made.lu.data() + std::ptrdiff_t{i} * f.columns();
    T* const t = pivots + i * m;
    const Divisor<T> over(row[i]);
    for (std::ptrdiff_t j = 0; j < m; ++j) t[j] = over(t[j]);
    for (int k = i + 1; k < f.pivot_count; ++k) subtract(m, row[k], t, pivots + k * m);
    const T* u = row + f.pivot_count;
    for (const int v : plan.list(f.border))
      for (int k = 0; k < plan.structure.variable_size[at(v)]; ++k)
        subtract(m, *u++, t, g + (plan.first[at(v)] + k) * m);
  }
}

/// The solutions of a front's rows, which go to its own rows and to those that its children left.
template <class T>
struct TransposedLower {
  const Plan& plan;
  std::ptrdiff_t m;  ///< columns
  const RowMatrix<T>& g;
  RowMatrix<T>&result, carried;
  std::vector<T> rows = {};
  std::vector<T*> entered = {};  ///< address of each row as it was assembled

  void run(const Front& f, const typename Factors<T>::Made& made) {
    rows.resize(at(f.row_count) * static_cast<std::size_t>(m));
    std::copy_n(g.data() + f.first_unknown * m, f.pivot_count * m, rows.data());
    std::copy_n(carried.data() + f.first_carried * m, f.left_over() * m,
                rows.data() + f.pivot_count * m);
    for (int i = f.row_count - 1; i > 0; --i) {
      const T* const l = made.lu.data() + std::ptrdiff_t{i} * f.columns();
      for (int k = 0; k < std::min(i, f.pivot_count); ++k)
        if (l[k] != T(0)) subtract(m, l[k], rows.data() + i * m, rows.data() + k * m);
    }
    find_entered(f);
    for (int i = 0; i < f.row_count; ++i)
      std::copy_n(rows.data() + i * m, m, entered[at(made.order[at(i)])]);
  }

  void find_entered(const Front& f) {
    entered.clear();
    const auto give = [&](T* to, int count) {
      for (int i = 0; i < count; ++i) entered.push_back(to + i * m);
    };
    for (const int r : plan.list(f.rows))
      give(result.data() + plan.row_first[at(r)] * m, plan.structure.row_size[at(r)]);
    for (const int c : plan.list(f.children)) {
      const Front& child = plan.fronts[at(c)];
      give(carried.data() + child.first_carried * m, child.left_over());
    }
  }
};

}  // namespace

template <class T>
RowMatrix<T> Factors<T>::solve_transposed(const RowMatrix<T>& rhs) const {
  const Plan& plan = *plan_;
  const std::ptrdiff_t m = rhs.cols();
  auto g = unwritten<T>(plan.unknowns, m), result = unwritten<T>(plan.unknowns, m),
       carried = unwritten<T>(plan.carried, m);
  g = rhs;
  for (std::size_t i = 0; i < fronts_.size(); ++i)
    transposed_upper(plan, plan.fronts[i], *fronts_[i], m, g.data());
  TransposedLower<T> lower{plan, m, g, result, carried};
  for (std::size_t i = fronts_.size(); i-- > 0;) lower.run(plan.fronts[i], *fronts_[i]);
  return result;
}

#define TITOP_INSTANTIATE(T) \
  template RowMatrix<T> Factors<T>::solve_transposed(const RowMatrix<T>&) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
