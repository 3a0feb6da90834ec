#pragma once

#include <titop/compiler/solve/numbers.hpp>

/// Refinement of every solution, in every precision, by the componentwise backward error.
namespace titop::solve {

/// Smaller numbers have no digits to keep: motion that has decayed along a chain of thousands.
inline constexpr double kUnderflow = 1e-290;

/// The largest ratio of a row's residual to its terms, |rhs - rows x| over |rhs| + |rows| |x|: the
/// least relative change of single entries and right-hand sides that makes x exact [Oettli, Prager
/// 1964]. The three rows of a translation, rotation, force or torque count together; columns
/// separately. Infinite if a number is not finite. Residuals below kUnderflow count as 0.
template <class T>
double backward_error(const Plan& plan, const RowMatrix<T>& residual,
                      const RowMatrix<double>& magnitudes);
/// The same of the transposed system, whose rows are the unknowns.
template <class T>
double transposed_backward_error(const Plan& plan, const RowMatrix<T>& residual,
                                 const RowMatrix<double>& magnitudes);

/// Its possible value by rounding alone: 8 (k + 8) units of rounding, k scalars in the longest row.
/// A row of k products, each of up to three factors, has an error of up to (k + 4) units of its
/// terms, and the solution itself, once refined in the same arithmetic, as much again [Skeel 1980;
/// N. J. Higham, Accuracy and Stability of Numerical Algorithms, 3.1 and 12.1]; a complex product
/// has up to 2 sqrt(2) units.
double backward_error_of_rounding(const Plan& plan, double epsilon);
/// The same of the transposed system, k scalars in the longest column.
double transposed_backward_error_of_rounding(const Plan& plan, double epsilon);

/// Solution by the factors alone, if the caller measures its losses; or refined.
enum class Refinement { none, settled };

/// Solves, and refines in the same arithmetic while the backward error is above rounding and falls
/// to half of its last value or less, five times at most (as LAPACK's xGERFS does). The backward
/// error alone is no reason to refuse: rows between unknowns that are 0 up to rounding, as at
/// points that closed chains immobilise, have a residual as large as their terms. Callers judge the
/// solution (RefinedSolution::holds). O(front sizes^2) and the rows once, per column. Adds the
/// columns solved for to `columns`, if it is given.
template <class T>
RowMatrix<T> settled(const JointRows<T>& rows, const Factors<T>& factors, const RowMatrix<T>& rhs,
                     int* columns = nullptr);
/// The same of the transposed system.
template <class T>
RowMatrix<T> transposed_settled(const JointRows<T>& rows, const Factors<T>& factors,
                                const RowMatrix<T>& rhs, int* columns = nullptr);

}  // namespace titop::solve
