#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

constexpr int kSteps = 5;

}  // namespace

template <class T>
double backward_error(const Plan& plan, const RowMatrix<T>& residual,
                      const RowMatrix<double>& magnitudes) {
  const std::ptrdiff_t m = residual.cols();
  double worst = 0;
  const auto take = [&](int row, int count) {
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
  };
  for (std::size_t r = 0; r < plan.row_first.size(); ++r) {
    const int size = plan.structure.row_size[r], unit = size == 6 ? 3 : 1;
    for (int i = 0; i < size; i += unit) take(plan.row_first[r] + i, unit);
  }
  return worst;
}

double backward_error_of_rounding(const Plan& plan, double epsilon) {
  const Structure& s = plan.structure;
  int longest = 0;
  for (int r = 0; r < static_cast<int>(s.row_size.size()); ++r) {
    int length = 0;
    for (const int v : s.row(r)) length += s.variable_size[at(v)];
    longest = std::max(longest, length);
  }
  return 8 * (longest + 8) * epsilon;
}

template <class T>
RowMatrix<T> settled(const JointRows<T>& rows, const Factors<T>& factors, const RowMatrix<T>& rhs) {
  const Plan& plan = factors.plan();
  const double enough = backward_error_of_rounding(plan, Scalar<T>::epsilon());
  RowMatrix<T> result = factors.solve(rhs);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    RowMatrix<double> magnitudes;
    const RowMatrix<T> residual = rows.residual(rhs, result, &magnitudes);
    const double now = backward_error(plan, residual, magnitudes);
    if (now <= enough || !(2 * now <= before) || step == kSteps) return result;
    before = now;
    result += factors.solve(residual);
  }
}

#define TITOP_INSTANTIATE(T)                                                                  \
  template double backward_error(const Plan&, const RowMatrix<T>&, const RowMatrix<double>&); \
  template RowMatrix<T> settled(const JointRows<T>&, const Factors<T>&, const RowMatrix<T>&);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
