#include <titop/compiler/certificate/around_states.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

namespace titop::detail {

using Eigen::VectorXd;
using linalg::at;
using solve::RowMatrix;

VectorXd AroundStates::of_output(std::size_t o) {
  const Output& output = d_.graph().outputs[o];
  const int first = d_.skeleton->joint.output_coefficient[o];
  VectorXd sum = VectorXd::Zero(output.size);
  for (std::size_t k = 0; k < output.terms.size(); ++k)
    if (const int x = output.terms[k].signal; d_.graph().signals[at(x)].role == Signal::Role::state)
      sum += d_.numbers.coefficients[at(first) + k]->cwiseAbs() * of_states(x);
  return sum;
}

const VectorXd& AroundStates::of_states(int states) {
  const auto [found, added] = sizes_.try_emplace(states);
  if (!added) return found->second;
  const int i = d_.graph().signals[at(states)].node;
  const Node& node = d_.graph().nodes[at(i)];
  const Dynamics& m = *d_.numbers.blocks[at(i)];
  VectorXd u = VectorXd::Zero(m.B.cols());
  for (int k = node.first_signal; k < node.state; ++k)
    if (const Signal& in = d_.graph().signals[at(k)]; in.role == Signal::Role::input && in.active)
      for (Eigen::Index j = 0; j < in.size; ++j) u(in.first + j) = around_.size(k, j);
  const auto X = response<double>(*node.block, m, s_, d_.numbers.parameters).X;
  found->second = (X.cwiseAbs() * u).cwiseMax(point_.value(states).col(0).cwiseAbs());
  return found->second;
}

RowMatrix<double> AroundStates::without_zeros(const RowMatrix<double>& y, RowMatrix<double> off) {
  bool doubt = false;
  for (std::size_t o = 0; o < d_.graph().outputs.size(); ++o) {
    const int size = d_.graph().outputs[o].size, unit = size == 6 ? 3 : 1;
    for (int i = 0; i < size; i += unit) {
      auto part = off.middleRows(d_.layout().output_first[o] + i, unit);
      const double value =
          y.middleRows(d_.layout().output_first[o] + i, unit).cwiseAbs().maxCoeff();
      if ((part.array().abs() <= kWarn * value).all()) continue;
      const double zero = kLeftOfZero * of_output(o).segment(i, unit).maxCoeff();
      if (value <= zero && (part.array().abs() <= zero).all())
        part.setZero();
      else
        doubt = true;
    }
  }
  if (doubt) d_.clear_zero_outputs(off);
  return off;
}

}  // namespace titop::detail
