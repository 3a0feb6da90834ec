#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/response.hpp>

namespace titop::detail {

using solve::kUnderflow;

/// The error of an evaluation at s, if s is a pole or numerically one.
Error no_digit_left(const Factored& data, std::complex<double> s);

/// The error if Evaluation::refinement_error() is too large.
Error not_refined(const Factored& data, std::complex<double> s, double error);

/// A larger change of the outputs needs another step of refinement, in any precision; a larger
/// error a finer precision, or it is refused.
constexpr double kEnough = 1e-12;
/// A result that the data, or their last place, change by more has not one digit.
constexpr double kOneDigit = 0.1;
/// Safety factor of the estimate of rounding, which is one sample of a random order: others have
/// been up to this factor larger.
constexpr double kRoundings = 4;

/// One column per input: unit vectors.
template <class T>
solve::RowMatrix<T> unit_inputs(const Factored& data) {
  const auto m = static_cast<Eigen::Index>(data.layout().inputs.size());
  solve::RowMatrix<T> u = solve::RowMatrix<T>::Zero(m, m);
  for (Eigen::Index i = 0; i < m; ++i) u(i, i) = T(1);
  return u;
}

/// A compiled diagram at one s, driven by its external inputs: every signal on demand. T is a
/// complex scalar of any precision, or double for a real s at less than half the cost; blocks that
/// are the same object are evaluated once.
template <class T>
class Evaluation {
 public:
  /// u: inputs x columns. Throws singular if s is a pole of the system or of a block.
  Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
             solve::Refinement refinement = solve::Refinement::none);
  /// `coarse`: the same s and u in double, whose factors are reused. Iterative refinement with
  /// blocks and residuals in T, until the outputs have settled or their changes shrink no more: see
  /// refinement_error().
  Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
             const Evaluation<std::complex<double>>& coarse);

  /// signal size x columns.
  solve::RowMatrix<T> value(int signal) const;

  /// All signals, one below the other: signal i from row first[i] on; first[signals] is the end.
  solve::RowMatrix<T> values(std::span<const int> first) const;

  /// The diagram's outputs x columns.
  solve::RowMatrix<T> outputs() const;

  /// Change of the outputs if the states are also forced, xdot = A x + B u + r (r: states x
  /// columns): C (s - A)^-1 r through the factors. O(bodies).
  solve::RowMatrix<T> forced(const solve::RowMatrix<T>& r) const;

  /// All blocks' states, driven by the external inputs alone.
  solve::RowMatrix<T> states() const;
  /// All blocks' states forced alone, inputs at 0: (s - A)^-1 r. O(bodies).
  solve::RowMatrix<T> forced_states(const solve::RowMatrix<T>& r) const;

  const solve::RowMatrix<T>& unknowns() const { return unknowns_; }
  solve::RowMatrix<T> solve(const solve::RowMatrix<T>& rhs) const { return factors_->solve(rhs); }
  /// With `coarse`: approximate upper bound of the error of the outputs: their change by the last
  /// step of refinement. 1 if a step did not reduce the error of some unknown, infinite if numbers
  /// have overflown. Measured per block of the transfer (a port by a port, dual vectors in halves),
  /// over the block's largest entry; if the change is more than 1e-3 of that and finer arithmetic
  /// confirms that the block is a 0 with rounding (Factored::zero_blocks), over the geometric
  /// mean of the largest entries of the block's row and column. (At a real s in double, and if
  /// columns are not one per input, every block that small counts as such a 0.)
  double refinement_error() const { return refinement_error_; }
  /// One step of refinement, residual and all in T: removes the error of the elimination itself
  /// (growth that no single pivot shows). Returns the change of the outputs, measured as above.
  double improve();
  /// Estimated errors of double (or another T).
  struct Losses {
    double change = 0;    ///< improve()
    double rounding = 0;  ///< the change of the outputs, measured as above, if every equation is
                          ///< off by about one unit of the last place of its terms, up or down in a
                          ///< fixed random order: an estimate of the error, not a bound
  };
  /// improve(), and the error by rounding. One solution of two columns per column.
  Losses losses();
  /// The change of the outputs by rounding as above, outputs x columns.
  solve::RowMatrix<T> rounding() const;
  /// Likewise of all signals, as values().
  solve::RowMatrix<T> rounding_of_values(std::span<const int> first) const;
  /// Weakest pivot of the elimination: see Certificate::weakest_pivot.
  double weakest_pivot() const { return factors_->health().weakest; }

 private:
  struct Driven {};  ///< rows and right-hand sides only
  Evaluation(Driven, const Factored& data, const T& s, const solve::RowMatrix<T>& u);
  /// Outputs from unknowns; the states' own parts are added if they are given.
  solve::RowMatrix<T> outputs_of(const solve::RowMatrix<T>& unknowns,
                                 const solve::RowMatrix<T>& inputs,
                                 const solve::RowMatrix<T>* states) const;
  solve::RowMatrix<T> values_of(const solve::RowMatrix<T>& unknowns,
                                const solve::RowMatrix<T>& inputs,
                                std::span<const int> first) const;
  /// Change of the unknowns by rounding.
  solve::RowMatrix<T> change_by_rounding() const;
  solve::RowMatrix<T> value_of(int signal, const solve::RowMatrix<T>& unknowns,
                               const solve::RowMatrix<T>& inputs) const;
  void refine(const Evaluation<std::complex<double>>& coarse);
  solve::RowMatrix<std::complex<double>> change_by(const Evaluation<std::complex<double>>& coarse,
                                                   double* rounding) const;
  /// Largest entries of unknowns that share a unit, variable by variable, for each group of
  /// columns.
  Eigen::ArrayXd sizes_of_unknowns(const solve::RowMatrix<std::complex<double>>& unknowns) const;
  /// The columns' groups, an input each, dual vectors in halves: their first ones, and the end.
  std::vector<Eigen::Index> groups_of_columns() const;
  /// One unit of the last place of these, up or down in a fixed random order, row by row.
  static solve::RowMatrix<T> rounding_of(const solve::RowMatrix<double>& magnitudes);
  double relative_to_outputs(const solve::RowMatrix<T>& change_of_unknowns) const;
  /// (s - A)^-1 of this node's block.
  const Resolvent<T>& resolvent(int node) const;
  /// (s - A)^-1 r of every block by itself.
  solve::RowMatrix<T> own_response(const solve::RowMatrix<T>& r) const;
  /// Effect of these on the interface unknowns.
  solve::RowMatrix<T> unknowns_of(const solve::RowMatrix<T>& own) const;

  solve::Matrices<T> respond(const T& s);

  const Factored& data_;
  T s_;
  solve::RowMatrix<T> u_;
  std::vector<int> first_;  ///< per signal: first row of u
  std::map<std::pair<const Block*, const Dynamics*>, solve::BlockResponse<T>> responses_;
  std::vector<const solve::BlockResponse<T>*> of_node_;
  mutable std::once_flag resolvents_once_;  ///< made if states are forced: few need them
  mutable std::map<const Dynamics*, Resolvent<T>> resolvents_;
  solve::JointRows<T> rows_;
  std::unique_ptr<const solve::Factors<T>> factors_;
  solve::RowMatrix<T> rhs_, unknowns_;
  double refinement_error_ = 0;
};

}  // namespace titop::detail
