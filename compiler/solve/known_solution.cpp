#include <cmath>
#include <titop/compiler/solve/known_solution.hpp>
#include <titop/compiler/solve/lifted_rows.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::Complex50;
using solve::in_double;
using solve::RowMatrix;

/// Steps of refinement; of a regular system each must shrink the error by half at least.
constexpr int kMostRefined = 10;

RowMatrix<double> known_solution(const Factored& d) {
  RowMatrix<double> x(d.skeleton->joint.plan->unknowns, 1);
  SteadyRandom random;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x(i) = std::ldexp(random.unit(), d.factors->scale()->of_unknowns[at(i)]);
  return x;
}

/// L x
template <class T>
RowMatrix<T> right_hand_side(const solve::JointRows<T>& rows, const RowMatrix<T>& x) {
  return -rows.residual(RowMatrix<T>::Zero(x.rows(), x.cols()), x);
}

}  // namespace

Eigen::ArrayXd errors_of_known_solution(const Factored& d) {
  const RowMatrix<double> x = known_solution(d);
  const auto rows = real_rows(*d.skeleton, d.numbers);
  const RowMatrix<double> found = d.factors->solve(right_hand_side(rows, x));
  return (found - x).cwiseQuotient(x).cwiseAbs().reshaped();
}

Eigen::ArrayXd errors_left_of_known_solution(const Factored& d) {
  const RowMatrix<double> x = known_solution(d);
  const LiftedRows<Complex50> lifted(d);
  const solve::JointRows<Complex50> rows = lifted.rows();
  const RowMatrix<Complex50> goal = solve::lifted<Complex50>(x), rhs = right_hand_side(rows, goal);
  RowMatrix<Complex50> found = RowMatrix<Complex50>::Zero(x.rows(), x.cols());
  Eigen::ArrayXd errors = Eigen::ArrayXd::Ones(x.rows());
  for (int step = 0; step < kMostRefined && !(errors <= kThreeDigits).all(); ++step) {
    found +=
        solve::lifted<Complex50>(d.factors->solve(in_double(rows.residual(rhs, found)).real()));
    errors = in_double(found - goal).real().cwiseQuotient(x).cwiseAbs().reshaped();
  }
  return errors;
}

}  // namespace titop::detail
