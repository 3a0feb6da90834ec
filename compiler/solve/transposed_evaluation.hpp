#pragma once

#include <titop/compiler/solve/evaluate.hpp>

namespace titop::detail {

/// Rows of the transfer at one s, by solutions of the transposed joint system: with z = L^-1 R u
/// and y = G z + H u they are G L^-1 R + H, where L'v = G'w gives v'R for the weights w of the
/// outputs. A row costs as much as a column in Evaluation, and depends on all inputs.
template <class T>
class TransposedEvaluation final : public RefinedSolution<T> {
 public:
  /// The rows of these outputs of the graph, a scalar each, at the s of `point`, whose factors it
  /// uses. `point` must outlive it.
  TransposedEvaluation(const Evaluation<T>& point, std::vector<int> ports,
                       solve::Refinement refinement = solve::Refinement::none);
  /// From the same rows in double, as Evaluation; `point` needs no factors.
  TransposedEvaluation(const Evaluation<T>& point, std::vector<int> ports,
                       const TransposedEvaluation<std::complex<double>>& coarse);

  /// The transposed rows: inputs x columns.
  solve::RowMatrix<T> inputs() const { return inputs_of(this->unknowns_, own_); }

  solve::RowMatrix<T> solve(const solve::RowMatrix<T>& rhs) const override {
    return point_.factors_->solve_transposed(rhs);
  }
  double weakest_pivot() const override { return point_.weakest_pivot(); }

 private:
  struct Weighted {};  ///< right-hand sides only
  TransposedEvaluation(Weighted, const Evaluation<T>& point, std::vector<int> ports);
  void add_weighted(int signal, const solve::RowMatrix<T>& weights);
  /// Of these unknowns, added to the direct terms from inputs to outputs.
  solve::RowMatrix<T> inputs_of(const solve::RowMatrix<T>& unknowns, solve::RowMatrix<T> own) const;
  solve::RowMatrix<T> residual(solve::RowMatrix<double>* magnitudes) const override {
    return point_.rows_.transposed_residual(rhs_, this->unknowns_, magnitudes);
  }
  double relative_to_results(const solve::RowMatrix<T>& change_of_unknowns) const override;
  double backward_error(const solve::RowMatrix<T>& residual,
                        const solve::RowMatrix<double>& magnitudes) const override {
    return solve::transposed_backward_error(plan(), residual, magnitudes);
  }
  double backward_error_of_rounding(double epsilon) const override {
    return solve::transposed_backward_error_of_rounding(plan(), epsilon);
  }
  Eigen::VectorXd unit_sizes() const override;
  Eigen::VectorXd sums_of(const Eigen::VectorXd& sizes) const override;
  const solve::Plan& plan() const { return *point_.data_.skeleton->as_written().plan; }
  Eigen::ArrayXd sizes_of_unknowns(
      const solve::RowMatrix<std::complex<double>>& unknowns) const override;

  const Evaluation<T>& point_;
  std::vector<int> ports_;
  solve::RowMatrix<T> rhs_;  ///< of the transposed system: unknowns x columns
  solve::RowMatrix<T> own_;  ///< inputs x columns: without the unknowns
};

}  // namespace titop::detail
