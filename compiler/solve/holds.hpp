#pragma once

#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/instant_in.hpp>
#include <titop/compiler/solve/scalar.hpp>

/// Whether unknowns solve equations to a rounding: the decision of RefinedSolution::holds, also for
/// the signals at an instant.
namespace titop::solve {

/// Equations between unknowns of so many columns: residual(&terms), backward_error(residual,
/// terms), backward_error_of_rounding(epsilon), unit_sizes(), sums_of(sizes), as RefinedSolution
/// has them.
template <class T, class Equations>
bool hold(const Equations& equations, const RowMatrix<T>& unknowns, double epsilon) {
  constexpr double kSmallTerms = 1000;
  RowMatrix<double> terms;
  const RowMatrix<T> off = equations.residual(&terms);
  const double rounding = equations.backward_error_of_rounding(epsilon);
  if (equations.backward_error(off, terms) <= rounding) return true;
  const Eigen::VectorXd unit = equations.unit_sizes(), sums = equations.sums_of(unit);
  const double small = kSmallTerms * static_cast<double>(off.rows()) * epsilon;
  for (Eigen::Index j = 0; j < off.cols(); ++j) {
    double largest = 0;
    for (Eigen::Index i = 0; i < unit.size(); ++i)
      largest = std::max(largest, size_of(unknowns(i, j)) / unit(i));
    for (Eigen::Index i = 0; i < off.rows(); ++i)
      if (const double most = sums(i) * largest; terms(i, j) <= small * most) terms(i, j) += most;
  }
  return equations.backward_error(off, terms) <= rounding;
}

/// settled(), and whether its backward error has come down to rounding: then the equations hold.
RowMatrix<double> settled(const JointRows<double>& rows, const Factors<double>& factors,
                          const RowMatrix<double>& rhs, bool& to_rounding);

}  // namespace titop::solve

namespace titop::detail {

/// The joint system at an instant, with its right-hand sides.
template <class T>
struct InstantEquations {
  const InstantIn<T>& now;
  const solve::RowMatrix<T>& rhs;

  const solve::Plan& plan() const { return now.data.factors->plan(); }
  solve::RowMatrix<T> residual(solve::RowMatrix<double>* terms) const {
    return now.rows.residual(rhs, now.unknowns, terms);
  }
  double backward_error(const solve::RowMatrix<T>& residual,
                        const solve::RowMatrix<double>& terms) const {
    return solve::backward_error(plan(), residual, terms);
  }
  double backward_error_of_rounding(double epsilon) const {
    return solve::backward_error_of_rounding(plan(), epsilon);
  }
  Eigen::VectorXd unit_sizes() const {
    const std::vector<std::int16_t>& exponents = now.data.factors->scale()->of_unknowns;
    Eigen::VectorXd sizes(std::ssize(exponents));
    for (Eigen::Index i = 0; i < sizes.size(); ++i)
      sizes(i) = std::ldexp(1.0, exponents[linalg::at(i)]);
    return sizes;
  }
  Eigen::VectorXd sums_of(const Eigen::VectorXd& sizes) const {
    const solve::RowMatrix<T> x = solve::lifted<T>(sizes),
                              none = solve::RowMatrix<T>::Zero(x.rows(), 1);
    solve::RowMatrix<double> sums;
    now.rows.residual(none, x, &sums);
    return sums.col(0);
  }
};

/// Whether the unknowns solve the joint system to this rounding.
template <class T>
bool holds(const InstantIn<T>& now, const solve::RowMatrix<T>& rhs, double epsilon) {
  return solve::hold<T>(InstantEquations<T>{now, rhs}, now.unknowns, epsilon);
}

}  // namespace titop::detail
