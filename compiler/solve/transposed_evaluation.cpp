#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/transposed_evaluation.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;

template <class T>
solve::RowMatrix<T> unit_outputs(const Factored& d, const std::vector<int>& ports) {
  const Layout& l = d.layout();
  return unit_vectors<T>(d.graph().outputs, l.output_first, l.outputs.size(), ports);
}

}  // namespace

template <class T>
TransposedEvaluation<T>::TransposedEvaluation(Weighted, const Evaluation<T>& point,
                                              std::vector<int> ports)
    : point_(point), ports_(std::move(ports)) {
  const Factored& d = point_.data_;
  const Graph& g = d.graph();
  const solve::RowMatrix<T> weights = unit_outputs<T>(d, ports_);
  const Index m = weights.cols();
  rhs_ = solve::RowMatrix<T>::Zero(d.skeleton->as_written().plan->unknowns, m);
  own_ = solve::RowMatrix<T>::Zero(static_cast<Index>(d.layout().inputs.size()), m);
  for (const int o : ports_)
    for (std::size_t k = 0; k < g.outputs[at(o)].terms.size(); ++k) {
      const auto& c = *d.numbers.coefficients[at(d.skeleton->joint.output_coefficient[at(o)]) + k];
      add_weighted(g.outputs[at(o)].terms[k].signal,
                   solve::lifted<T>(c).transpose().lazyProduct(
                       weights.middleRows(d.layout().output_first[at(o)], g.outputs[at(o)].size)));
    }
}

/// Adds the outputs' gains on this signal to the right-hand side; those on a state by way of the
/// inputs of its block.
template <class T>
void TransposedEvaluation<T>::add_weighted(int signal, const solve::RowMatrix<T>& weights) {
  const Graph& g = point_.data_.graph();
  const Signal& s = g.signals[at(signal)];
  if (s.role != Signal::Role::state)
    return point_.rows_.add_transposed_value(signal, weights.data(), point_.first_, rhs_, own_);
  if (!s.active) return;
  const solve::Dense<T>& X = point_.of_node_[at(s.node)]->X;
  for (int i = g.nodes[at(s.node)].first_signal; i < signal; ++i)
    if (const Signal& in = g.signals[at(i)]; in.role == Signal::Role::input)
      add_weighted(i, X.middleCols(in.first, in.size).transpose().lazyProduct(weights));
}

template <class T>
TransposedEvaluation<T>::TransposedEvaluation(const Evaluation<T>& point, std::vector<int> ports,
                                              solve::Refinement refinement)
    : TransposedEvaluation(Weighted(), point, std::move(ports)) {
  if (refinement == solve::Refinement::settled) {
    this->unknowns_ =
        solve::transposed_settled(point_.rows_, *point_.factors_, rhs_, &this->columns_solved_);
  } else {
    this->unknowns_ = solve(rhs_);
    this->columns_solved_ = static_cast<int>(rhs_.cols());
  }
}

template <class T>
TransposedEvaluation<T>::TransposedEvaluation(
    const Evaluation<T>& point, std::vector<int> ports,
    const TransposedEvaluation<std::complex<double>>& coarse)
    : TransposedEvaluation(Weighted(), point, std::move(ports)) {
  this->refine(coarse);
}

template <class T>
solve::RowMatrix<T> TransposedEvaluation<T>::inputs_of(const solve::RowMatrix<T>& unknowns,
                                                       solve::RowMatrix<T> own) const {
  point_.rows_.add_transposed_rhs(unknowns, point_.first_, own);
  return own;
}

/// Inputs that no output sees have rows of 0 here, filled with rounding: the unknowns v are not
/// exactly 0 there.
template <class T>
double TransposedEvaluation<T>::relative_to_results(const solve::RowMatrix<T>& change) const {
  const Factored& d = point_.data_;
  const PortGroups rows = groups_of_inputs(d, all_inputs(d)), cols = groups_of_outputs(d, ports_);
  const solve::RowMatrix<T> none = solve::RowMatrix<T>::Zero(own_.rows(), own_.cols());
  return relative_change(solve::in_double(inputs()), solve::in_double(inputs_of(change, none)),
                         rows, cols, [&](Index i, Index j) {
                           const Eigen::MatrixX<bool>& zeros = d.zero_blocks();
                           if (!zeros(cols.index[at(j)], rows.index[at(i)])) return ZeroBlock::no;
                           return zeros.all() ? ZeroBlock::assumed : ZeroBlock::confirmed;
                         });
}

/// Rows of a twist or wrench share a unit in halves; the columns' groups are those of the outputs.
template <class T>
Eigen::ArrayXd TransposedEvaluation<T>::sizes_of_unknowns(
    const solve::RowMatrix<std::complex<double>>& unknowns) const {
  const solve::Plan& plan = *point_.data_.skeleton->as_written().plan;
  const std::vector<Index> cols = groups_of_outputs(point_.data_, ports_).first;
  std::vector<double> sizes;
  for (std::size_t r = 0; r < plan.row_first.size(); ++r) {
    const int size = plan.structure.row_size[r], unit = size == 6 ? 3 : 1;
    for (int i = 0; i < size; i += unit)
      for (std::size_t j = 0; j + 1 < cols.size(); ++j)
        sizes.push_back(
            unknowns.block(plan.row_first[r] + i, cols[j], unit, cols[j + 1] - cols[j])
                .unaryExpr([](const std::complex<double>& x) { return solve::size_of(x); })
                .maxCoeff());
  }
  return Eigen::Map<const Eigen::ArrayXd>(sizes.data(), std::ssize(sizes));
}

/// Those of the rows of the system itself, of which these unknowns are the weights.
template <class T>
Eigen::VectorXd TransposedEvaluation<T>::unit_sizes() const {
  return point_.sums_of(point_.unit_sizes()).unaryExpr([](double x) { return x > 0 ? 1 / x : 1; });
}

template <class T>
Eigen::VectorXd TransposedEvaluation<T>::sums_of(const Eigen::VectorXd& sizes) const {
  const solve::RowMatrix<T> x = solve::lifted<T>(sizes),
                            none = solve::RowMatrix<T>::Zero(x.rows(), 1);
  solve::RowMatrix<double> sums;
  point_.rows_.transposed_residual(none, x, &sums);
  return sums.col(0);
}

#define TITOP_INSTANTIATE(T) template class TransposedEvaluation<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
