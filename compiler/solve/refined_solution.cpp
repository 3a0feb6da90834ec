#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/holds.hpp>
#include <titop/compiler/solve/refined_solution.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

/// Error estimate and refinement at one s.
namespace titop::detail {
namespace {

/// If steps shrink by less, refinement ends: at the rounding of T, or without a result if that is
/// not reached.
using linalg::kShrinks;
using solve::in_double;
using solve::lifted;

/// Most steps of refinement: at kShrinks each they lead to 1e-18.
constexpr int kSteps = 30;
/// If the first step changes no block of the unknowns by more, convergence is certain by then;
/// otherwise a later step must confirm it, up to kUntil after the first.
constexpr double kPlain = 1e-9;
constexpr int kUntil = 2;

bool at_most(const Eigen::ArrayXd& change, const Eigen::ArrayXd& limit) {
  return (change <= limit.max(kUnderflow)).all();
}

}  // namespace

template <class T>
double RefinedSolution<T>::improve() {
  const solve::RowMatrix<T> correction = solve(residual(nullptr));
  columns_solved_ += static_cast<int>(correction.cols());
  unknowns_ += correction;
  return relative_to_results(correction);
}

template <class T>
solve::RowMatrix<T> RefinedSolution<T>::rounding_of(const solve::RowMatrix<double>& magnitudes) {
  SteadyRandom random;
  auto result = solve::unwritten<T>(magnitudes.rows(), magnitudes.cols());
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const double unit = random.unit() * solve::Scalar<T>::epsilon();
    for (Eigen::Index j = 0; j < result.cols(); ++j)
      result(i, j) = solve::lift<T>(unit * magnitudes(i, j));
  }
  return result;
}

/// One solution of twice the columns serves both.
template <class T>
typename RefinedSolution<T>::Losses RefinedSolution<T>::losses() {
  solve::RowMatrix<double> magnitudes;
  const solve::RowMatrix<T> off = residual(&magnitudes);
  const auto m = off.cols();
  auto both = solve::unwritten<T>(off.rows(), 2 * m);
  both << off, rounding_of(magnitudes);
  const solve::RowMatrix<T> changes = solve(both);
  columns_solved_ += static_cast<int>(changes.cols());
  unknowns_ += changes.leftCols(m);
  return {relative_to_results(changes.leftCols(m)), relative_to_results(changes.rightCols(m))};
}

template <class T>
bool RefinedSolution<T>::hold_to(double epsilon) const {
  struct Equations {
    const RefinedSolution& of;
    auto residual(solve::RowMatrix<double>* terms) const { return of.residual(terms); }
    double backward_error(const solve::RowMatrix<T>& off,
                          const solve::RowMatrix<double>& terms) const {
      return of.backward_error(off, terms);
    }
    double backward_error_of_rounding(double eps) const {
      return of.backward_error_of_rounding(eps);
    }
    Eigen::VectorXd unit_sizes() const { return of.unit_sizes(); }
    Eigen::VectorXd sums_of(const Eigen::VectorXd& sizes) const { return of.sums_of(sizes); }
  };
  return solve::hold<T>(Equations{*this}, unknowns_, epsilon);
}

template <class T>
bool RefinedSolution<T>::holds() const {
  return hold_to(solve::Scalar<T>::epsilon());
}

template <class T>
solve::RowMatrix<T> RefinedSolution<T>::change_by_rounding() const {
  solve::RowMatrix<double> magnitudes;
  residual(&magnitudes);
  return solve(rounding_of(magnitudes));
}

/// The step of refinement from here. `rounding`, if given: about the error of the results by the
/// rounding of T: at mass ratios of 1e18, 32 digits leave few.
template <class T>
solve::RowMatrix<std::complex<double>> RefinedSolution<T>::change_by(
    const RefinedSolution<Double>& coarse, double* rounding) {
  columns_solved_ += static_cast<int>((rounding ? 2 : 1) * unknowns_.cols());
  if (!rounding) return coarse.solve(in_double(residual(nullptr)));
  solve::RowMatrix<double> magnitudes;
  const solve::RowMatrix<T> off = residual(&magnitudes);
  const auto m = off.cols();
  solve::RowMatrix<Double> both(off.rows(), 2 * m);
  both << in_double(off), in_double(rounding_of(magnitudes));
  const solve::RowMatrix<Double> changes = coarse.solve(both);
  *rounding = kRoundings * relative_to_results(lifted<T>(changes.rightCols(m)));
  return changes.leftCols(m);
}

/// Every step multiplies the error by I - F^-1 L (F: the factors, L: the matrix), and so the step
/// itself: a component in which F is inaccurate shrinks slowly, or not at all, and small steps do
/// not imply a small error. Convergence is judged by each of the unknowns, not by the results, of
/// which that component may be a small fraction.
template <class T>
void RefinedSolution<T>::refine_until_settled(const RefinedSolution<Double>& coarse) {
  unknowns_ = lifted<T>(coarse.unknowns());
  const Eigen::ArrayXd start = sizes_of_unknowns(coarse.unknowns());  // the step from 0
  Eigen::ArrayXd first_step;
  double before = 1, rounding = 0;
  bool leads = false;
  for (int step = 0; step < kSteps; ++step) {
    // If the first step is sufficient, it is so small that the rounding of T, far finer, is
    // negligible.
    const solve::RowMatrix<std::complex<double>> change =
        change_by(coarse, step == 1 ? &rounding : nullptr);
    const solve::RowMatrix<T> correction = lifted<T>(change);
    unknowns_ += correction;
    const double now = relative_to_results(correction);
    if (!leads) {
      const Eigen::ArrayXd sizes = sizes_of_unknowns(change);
      // A 0 with rounding is changed altogether by the first step, by the second one if the first
      // has rounded it as much again, and not by later ones.
      if (step == 0) first_step = sizes.max(0x1p-53 * start);
      leads = at_most(sizes, step == 0 ? Eigen::ArrayXd(kPlain * start)
                                       : Eigen::ArrayXd(std::pow(kShrinks, step) * first_step));
    }
    refinement_error_ = leads || std::isinf(now) ? std::max(now, rounding) : 1;
    if (std::isinf(now) || (step == kUntil && !leads)) return;
    // Prediction of the next step's change: this one's, times the same factor.
    const bool settled =
        now == 0 || (now <= kEnough && now * (now / before) <= solve::Scalar<T>::epsilon());
    if (leads && (settled || (step > 0 && !(now <= kShrinks * before)))) return;
    before = now;
  }
}

template <class T>
void RefinedSolution<T>::refine(const RefinedSolution<Double>& coarse) {
  refine_until_settled(coarse);
  if (refinement_error_ <= kEnough && !hold_to(solve::Scalar<double>::epsilon()))
    refinement_error_ = 1;
}

template class RefinedSolution<double>;
#define TITOP_INSTANTIATE(T) template class RefinedSolution<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
