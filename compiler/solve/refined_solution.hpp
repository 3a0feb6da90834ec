#pragma once

#include <complex>
#include <titop/compiler/solve/storage.hpp>

namespace titop::detail {

/// Solution of the joint system at one s, or of the transposed one, for some right-hand sides: its
/// errors, and their refinement. T as in Evaluation.
template <class T>
class RefinedSolution {
 public:
  virtual ~RefinedSolution() = default;

  /// Of the system: unknowns; of the transposed one: a number per row.
  const solve::RowMatrix<T>& unknowns() const { return unknowns_; }
  /// Through the factors in T.
  virtual solve::RowMatrix<T> solve(const solve::RowMatrix<T>& rhs) const = 0;
  /// Weakest pivot of the elimination: see Certificate::weakest_pivot.
  virtual double weakest_pivot() const = 0;
  /// Right-hand sides solved for so far by the constructor, improve() and losses(), those of the
  /// refinement of a given solution in T included.
  int columns_solved() const { return columns_solved_; }

  /// After refine(): approximate upper bound of the error of the results: their change by the last
  /// step of refinement. 1 if a step did not reduce the error of some unknown, or if the unknowns
  /// do not solve the equations to the rounding of double (see holds); infinite if numbers have
  /// overflown. Measured per block of the transfer (a port by a port, dual vectors in halves), over
  /// the block's largest entry; if the change is more than 1e-3 of that and finer arithmetic
  /// confirms that the block is a 0 with rounding (Factored::zero_blocks), over the geometric
  /// mean of the largest entries of the block's row and column. (At a real s in double, and if
  /// columns are not one per input, every block that small counts as such a 0.)
  double refinement_error() const { return refinement_error_; }
  /// One step of refinement, residual and all in T: removes the error of the elimination itself
  /// (growth that no single pivot shows). Returns the change of the results, measured as above.
  double improve();
  /// Estimated errors of double (or another T).
  struct Losses {
    double change = 0;    ///< improve()
    double rounding = 0;  ///< the change of the results, measured as above, if every equation is
                          ///< off by about one unit of the last place of its terms, up or down in a
                          ///< fixed random order: an estimate of the error, not a bound
  };
  /// improve(), and the error by rounding. One solution of two columns per column.
  Losses losses();
  /// Whether the unknowns as they are, after the last step, solve the equations to the rounding of
  /// T: the exact solution of equations whose coefficients differ by that from these. The residual
  /// of each row must be at most the rounding (solve/backward_error.hpp) of its terms |b| + |A|
  /// |x|. If these are below 1000 n eps of |A| max|x|, with n unknowns in the sizes that
  /// equilibrate the equations, |A| max|x| is added to them: between unknowns that are 0 up to
  /// rounding, as at a pinned point, terms are rounding themselves [M. Arioli, J. W. Demmel, I. S.
  /// Duff, Solving sparse linear systems with sparse backward error, 1989]. Cost: the rows once per
  /// column, and once more if a residual is above the rounding of the row's own terms; no solution.
  bool holds() const;

 protected:
  using Double = std::complex<double>;

  /// Of the present unknowns, with the magnitudes of its terms.
  virtual solve::RowMatrix<T> residual(solve::RowMatrix<double>* magnitudes) const = 0;
  /// Relative change of the results if the unknowns change by this, measured as above.
  virtual double relative_to_results(const solve::RowMatrix<T>& change_of_unknowns) const = 0;
  /// Largest entries of unknowns that share a unit, for each group of columns.
  virtual Eigen::ArrayXd sizes_of_unknowns(const solve::RowMatrix<Double>& unknowns) const = 0;
  /// Of a residual, and its possible value by rounding alone: solve/backward_error.hpp.
  virtual double backward_error(const solve::RowMatrix<T>& residual,
                                const solve::RowMatrix<double>& magnitudes) const = 0;
  virtual double backward_error_of_rounding(double epsilon) const = 0;
  /// Sizes of the unknowns that equilibrate the equations.
  virtual Eigen::VectorXd unit_sizes() const = 0;
  /// Per equation the sum of its coefficients' magnitudes times these sizes of the unknowns.
  virtual Eigen::VectorXd sums_of(const Eigen::VectorXd& sizes) const = 0;

  /// From the same solution in double, whose factors are reused.
  void refine(const RefinedSolution<Double>& coarse);
  /// Change of the unknowns by rounding.
  solve::RowMatrix<T> change_by_rounding() const;

  solve::RowMatrix<T> unknowns_;
  int columns_solved_ = 0;

 private:
  /// holds(), to this rounding.
  bool hold_to(double epsilon) const;
  void refine_until_settled(const RefinedSolution<Double>& coarse);
  /// One unit of the last place of these, up or down in a fixed random order, row by row.
  static solve::RowMatrix<T> rounding_of(const solve::RowMatrix<double>& magnitudes);
  solve::RowMatrix<Double> change_by(const RefinedSolution<Double>& coarse, double* rounding);

  double refinement_error_ = 0;
};

}  // namespace titop::detail
