#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/refined_solution.hpp>
#include <titop/compiler/solve/response.hpp>
#include <titop/compiler/solve/transfer_blocks.hpp>

namespace titop::detail {

using solve::kUnderflow;

/// The error of an evaluation at s, if s is a pole or numerically one.
Error no_digit_left(const Factored& data, std::complex<double> s);

/// A larger change of the outputs needs another step of refinement, in any precision; a larger
/// error a finer precision, or it is refused.
constexpr double kEnough = 1e-12;
/// Safety factor of the estimate of rounding, which is one sample of a random order: others have
/// been up to this factor larger.
constexpr double kRoundings = 4;

/// Unit vectors of the scalars of these ports, inputs or outputs of the graph (`list`, with their
/// first places), in this order, among `all` scalars.
template <class T, class List>
solve::RowMatrix<T> unit_vectors(const List& list, const std::vector<int>& first, std::size_t all,
                                 const std::vector<int>& ports) {
  Eigen::Index columns = 0, column = 0;
  for (const int p : ports) columns += list[static_cast<std::size_t>(p)].size;
  solve::RowMatrix<T> u = solve::RowMatrix<T>::Zero(static_cast<Eigen::Index>(all), columns);
  for (const int p : ports)
    for (int i = 0; i < list[static_cast<std::size_t>(p)].size; ++i)
      u(first[static_cast<std::size_t>(p)] + i, column++) = T(1);
  return u;
}

template <class T>
solve::RowMatrix<T> unit_inputs(const Factored& data, const std::vector<int>& ports) {
  const Layout& l = data.layout();
  return unit_vectors<T>(data.graph().inputs, l.input_first, l.inputs.size(), ports);
}

/// One column per input.
template <class T>
solve::RowMatrix<T> unit_inputs(const Factored& data) {
  return unit_inputs<T>(data, all_inputs(data));
}

/// A compiled diagram at one s, driven by its external inputs: every signal on demand. T is a
/// complex scalar of any precision, or double for a real s at less than half the cost; blocks that
/// are the same object are evaluated once.
template <class T>
class Evaluation final : public RefinedSolution<T> {
 public:
  /// u: inputs x columns. Throws singular if s is a pole of the system or of a block. `ports`: the
  /// inputs of the graph whose unit vectors these are (unit_inputs); all if u is square.
  Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
             solve::Refinement refinement = solve::Refinement::none,
             std::optional<std::vector<int>> ports = {});
  /// `coarse`: the same s and u in double, whose factors are reused. Iterative refinement with
  /// blocks and residuals in T, until the outputs have settled or their changes shrink no more: see
  /// refinement_error().
  Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
             const Evaluation<std::complex<double>>& coarse,
             std::optional<std::vector<int>> ports = {});

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

  solve::RowMatrix<T> solve(const solve::RowMatrix<T>& rhs) const override {
    return factors_->solve(rhs);
  }
  double weakest_pivot() const override { return factors_->health().weakest; }
  /// Its variable of the joint system; -1 if no pivot has lost digits.
  int weakest_variable() const { return factors_->health().weakest_variable; }

  /// The change of the outputs by rounding (Losses::rounding), outputs x columns.
  solve::RowMatrix<T> rounding() const;
  /// Likewise of all signals, as values().
  solve::RowMatrix<T> rounding_of_values(std::span<const int> first) const;

 private:
  template <class>
  friend class TransposedEvaluation;
  struct Driven {};  ///< rows and right-hand sides only
  Evaluation(Driven, const Factored& data, const T& s, const solve::RowMatrix<T>& u,
             std::optional<std::vector<int>> ports);
  /// Outputs from unknowns; the states' own parts are added if they are given.
  solve::RowMatrix<T> outputs_of(const solve::RowMatrix<T>& unknowns,
                                 const solve::RowMatrix<T>& inputs,
                                 const solve::RowMatrix<T>* states) const;
  solve::RowMatrix<T> values_of(const solve::RowMatrix<T>& unknowns,
                                const solve::RowMatrix<T>& inputs,
                                std::span<const int> first) const;
  solve::RowMatrix<T> value_of(int signal, const solve::RowMatrix<T>& unknowns,
                               const solve::RowMatrix<T>& inputs) const;
  using RefinedSolution<T>::unknowns_;
  using RefinedSolution<T>::columns_solved_;
  using RefinedSolution<T>::change_by_rounding;
  solve::RowMatrix<T> residual(solve::RowMatrix<double>* magnitudes) const override {
    return rows_.residual(rhs_, unknowns_, magnitudes);
  }
  double relative_to_results(const solve::RowMatrix<T>& change_of_unknowns) const override;
  double backward_error(const solve::RowMatrix<T>& residual,
                        const solve::RowMatrix<double>& magnitudes) const override {
    return solve::backward_error(*data_.skeleton->as_written().plan, residual, magnitudes);
  }
  double backward_error_of_rounding(double epsilon) const override {
    return solve::backward_error_of_rounding(*data_.skeleton->as_written().plan, epsilon);
  }
  Eigen::VectorXd unit_sizes() const override;
  Eigen::VectorXd sums_of(const Eigen::VectorXd& sizes) const override;
  Eigen::ArrayXd sizes_of_unknowns(
      const solve::RowMatrix<std::complex<double>>& unknowns) const override;
  /// The columns' groups.
  PortGroups groups_of_columns() const;
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
  std::optional<std::vector<int>> ports_;
  std::vector<int> first_;  ///< per signal: first row of u
  std::map<std::pair<const Block*, const Dynamics*>, solve::BlockResponse<T>> responses_;
  std::vector<const solve::BlockResponse<T>*> of_node_;
  mutable std::once_flag resolvents_once_;  ///< made if states are forced: few need them
  mutable std::map<const Dynamics*, Resolvent<T>> resolvents_;
  solve::JointRows<T> rows_;
  std::unique_ptr<const solve::Factors<T>> factors_;
  solve::RowMatrix<T> rhs_;
};

}  // namespace titop::detail
