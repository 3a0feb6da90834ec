#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/holds.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

constexpr int kSteps = 5;

/// The largest ratio of residuals to their terms; for_groups(take) calls take(first row, count) for
/// the rows that count together.
template <class T, class ForGroups>
double largest_ratio_of(const RowMatrix<T>& residual, const RowMatrix<double>& magnitudes,
                        ForGroups for_groups) {
  const std::ptrdiff_t m = residual.cols();
  double worst = 0;
  for_groups([&](int row, int count) {
    for (std::ptrdiff_t j = 0; j < m; ++j) {
      double off = 0, of = 0;
      for (int i = row; i < row + count; ++i) {
        off = std::max(off, size_of(residual(i, j)));
        of = std::max(of, magnitudes(i, j));
        if (!std::isfinite(size_of(residual(i, j))))
          worst = std::numeric_limits<double>::infinity();
      }
      if (off > kUnderflow && off > worst * of) worst = off / of;
    }
  });
  return worst;
}

/// Solves and refines: solve(rhs), residual(x, &magnitudes), error(residual, magnitudes). Adds the
/// columns solved for to `columns`, and says whether the error is `enough` in the end, if they are
/// given.
template <class T, class Solve, class Residual, class Error>
RowMatrix<T> refined_until(double enough, const RowMatrix<T>& rhs, Solve solve, Residual residual,
                           Error error, int* columns, bool* is_enough = nullptr) {
  const auto count = [&] {
    if (columns) *columns += static_cast<int>(rhs.cols());
  };
  RowMatrix<T> result = solve(rhs);
  count();
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    RowMatrix<double> magnitudes;
    const RowMatrix<T> off = residual(result, &magnitudes);
    const double now = error(off, magnitudes);
    if (is_enough) *is_enough = now <= enough;
    if (now <= enough || !(2 * now <= before) || step == kSteps) return result;
    before = now;
    result += solve(off);
    count();
  }
}

double of_rounding(int longest, double epsilon) { return 8 * (longest + 8) * epsilon; }

}  // namespace

template <class T>
double backward_error(const Plan& plan, const RowMatrix<T>& residual,
                      const RowMatrix<double>& magnitudes) {
  return largest_ratio_of(residual, magnitudes, [&](auto take) {
    for (std::size_t r = 0; r < plan.row_first.size(); ++r) {
      const int size = plan.structure.row_size[r], unit = size == 6 ? 3 : 1;
      for (int i = 0; i < size; i += unit) take(plan.row_first[r] + i, unit);
    }
  });
}

template <class T>
double transposed_backward_error(const Plan& plan, const RowMatrix<T>& residual,
                                 const RowMatrix<double>& magnitudes) {
  return largest_ratio_of(residual, magnitudes, [&](auto take) {
    for (std::size_t v = 0; v < plan.first.size(); ++v) {
      const int unit = plan.structure.variable_unit[v];
      for (int i = 0; i < plan.structure.variable_size[v]; i += unit) take(plan.first[v] + i, unit);
    }
  });
}

double backward_error_of_rounding(const Plan& plan, double epsilon) {
  const Structure& s = plan.structure;
  int longest = 0;
  for (int r = 0; r < static_cast<int>(s.row_size.size()); ++r) {
    int length = 0;
    for (const int v : s.row(r)) length += s.variable_size[at(v)];
    longest = std::max(longest, length);
  }
  return of_rounding(longest, epsilon);
}

double transposed_backward_error_of_rounding(const Plan& plan, double epsilon) {
  const Structure& s = plan.structure;
  std::vector<int> length(s.variable_size.size(), 0);
  for (int r = 0; r < static_cast<int>(s.row_size.size()); ++r)
    for (const int v : s.row(r)) length[at(v)] += s.row_size[at(r)];
  return of_rounding(length.empty() ? 0 : *std::max_element(length.begin(), length.end()), epsilon);
}

namespace {

template <class T>
RowMatrix<T> settled_by(const JointRows<T>& rows, const Factors<T>& factors,
                        const RowMatrix<T>& rhs, int* columns, bool* to_rounding) {
  const Plan& plan = factors.plan();
  return refined_until<T>(
      backward_error_of_rounding(plan, Scalar<T>::epsilon()), rhs,
      [&](const RowMatrix<T>& b) { return factors.solve(b); },
      [&](const RowMatrix<T>& x, RowMatrix<double>* sizes) { return rows.residual(rhs, x, sizes); },
      [&](const RowMatrix<T>& r, const RowMatrix<double>& sizes) {
        return backward_error(plan, r, sizes);
      },
      columns, to_rounding);
}

}  // namespace

template <class T>
RowMatrix<T> settled(const JointRows<T>& rows, const Factors<T>& factors, const RowMatrix<T>& rhs,
                     int* columns) {
  return settled_by(rows, factors, rhs, columns, nullptr);
}

RowMatrix<double> settled(const JointRows<double>& rows, const Factors<double>& factors,
                          const RowMatrix<double>& rhs, bool& to_rounding) {
  return settled_by(rows, factors, rhs, nullptr, &to_rounding);
}

template <class T>
RowMatrix<T> transposed_settled(const JointRows<T>& rows, const Factors<T>& factors,
                                const RowMatrix<T>& rhs, int* columns) {
  const Plan& plan = factors.plan();
  return refined_until<T>(
      transposed_backward_error_of_rounding(plan, Scalar<T>::epsilon()), rhs,
      [&](const RowMatrix<T>& b) { return factors.solve_transposed(b); },
      [&](const RowMatrix<T>& x, RowMatrix<double>* sizes) {
        return rows.transposed_residual(rhs, x, sizes);
      },
      [&](const RowMatrix<T>& r, const RowMatrix<double>& sizes) {
        return transposed_backward_error(plan, r, sizes);
      },
      columns);
}

#define TITOP_INSTANTIATE(T)                                                                  \
  template double backward_error(const Plan&, const RowMatrix<T>&, const RowMatrix<double>&); \
  template double transposed_backward_error(const Plan&, const RowMatrix<T>&,                 \
                                            const RowMatrix<double>&);                        \
  template RowMatrix<T> settled(const JointRows<T>&, const Factors<T>&, const RowMatrix<T>&,  \
                                int*);                                                        \
  template RowMatrix<T> transposed_settled(const JointRows<T>&, const Factors<T>&,            \
                                           const RowMatrix<T>&, int*);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
