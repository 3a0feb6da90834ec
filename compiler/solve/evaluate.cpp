#include <fmt/format.h>

#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/pole.hpp>

namespace titop::detail {
namespace {

using linalg::at;

using solve::lifted;

/// Nodes whose rows or states are in use.
std::vector<char> nodes_in_use(const Skeleton& k) {
  std::vector<char> used(k.stage.graph.nodes.size(), 0);
  for (const Row& row : k.stage.rows)
    if (row.active && row.node >= 0) used[at(row.node)] = 1;
  for (const int i : k.layout.state_nodes) used[at(i)] = 1;
  return used;
}

/// The error of a node's block with the node's name and the way out.
Error named(const Error& error, const Node& node) {
  std::vector<Mistake> mistakes = error.mistakes();
  for (Mistake& m : mistakes) {
    m.message = fmt::format("{}: {}", node.name, m.message);
    if (m.code == Code::singular)
      m.hint =
          "evaluate at another s; where the system has no pole, System::state_space().transfer(s) "
          "has "
          "a value there";
  }
  return Error(std::move(mistakes));
}

template <class T>
solve::BlockResponse<T> response_of(const Node& node, const Dynamics& dynamics, const T& s,
                                    ParameterValues parameters) {
  try {
    return response(*node.block, dynamics, s, parameters);
  } catch (const Error& error) {
    throw named(error, node);
  }
}

}  // namespace

Error no_digit_left(const Factored& data, std::complex<double> s) {
  return {Code::singular,
          fmt::format("{} has a pole at s = {}{:+}j, or no digit remains there in this precision",
                      data.graph().name, s.real(), s.imag()),
          "evaluate at another s, or with Precision::digits50"};
}

template <class T>
solve::Matrices<T> Evaluation<T>::respond(const T& s) {
  const Graph& g = data_.graph();
  check_finite(solve::Scalar<T>::round(s), g.name);
  const std::vector<char> used = nodes_in_use(*data_.skeleton);
  of_node_.assign(g.nodes.size(), nullptr);
  solve::Matrices<T> m;
  m.direct.assign(g.nodes.size(), nullptr);
  m.states.assign(g.nodes.size(), nullptr);
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i) {
    if (!used[at(i)]) continue;
    const Block& block = *g.nodes[at(i)].block;
    const Dynamics& dynamics = *data_.numbers.blocks[at(i)];
    const auto [found, added] = responses_.try_emplace({&block, &dynamics});
    if (added) found->second = response_of(g.nodes[at(i)], dynamics, s, data_.numbers.parameters);
    of_node_[at(i)] = &found->second;
    m.direct[at(i)] = &found->second.Y;
    m.states[at(i)] = &found->second.X;
  }
  return m;
}

template <class T>
Evaluation<T>::Evaluation(Driven, const Factored& data, const T& s, const solve::RowMatrix<T>& u,
                          std::optional<std::vector<int>> ports)
    : data_(data),
      s_(s),
      u_(u),
      ports_(std::move(ports)),
      first_(data.graph().signals.size(), -1),
      rows_(data.graph(), data.skeleton->as_written(), data.numbers.coefficients, respond(s)) {
  const int states = static_cast<int>(data.layout().states.size());
  for (const Input& i : data.graph().inputs)
    first_[at(i.signal)] = data.layout().known_first[at(i.signal)] - states;
  if (!ports_ && u_.rows() == u_.cols()) ports_ = all_inputs(data);
  rhs_ = rows_.rhs(u_, first_);
}

template <class T>
Evaluation<T>::Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
                          const Evaluation<std::complex<double>>& coarse,
                          std::optional<std::vector<int>> ports)
    : Evaluation(Driven(), data, s, u, std::move(ports)) {
  this->refine(coarse);
}

template <class T>
Evaluation<T>::Evaluation(const Factored& data, const T& s, const solve::RowMatrix<T>& u,
                          solve::Refinement refinement, std::optional<std::vector<int>> ports)
    : Evaluation(Driven(), data, s, u, std::move(ports)) {
  factors_ = std::make_unique<const solve::Factors<T>>(data.skeleton->as_written().plan, rows_,
                                                       data.scale());
  if (const solve::Health h = factors_->health(); h.singular) {
    const std::complex<double> z = solve::Scalar<T>::round(s);
    if (!h.finite)
      throw Error(
          Code::not_finite,
          fmt::format("{} at s = {}{:+}j: numbers overflow", data.graph().name, z.real(), z.imag()),
          "take an s of smaller or larger modulus, or other units");
    throw no_digit_left(data, z);
  }
  if (refinement == solve::Refinement::settled) {
    unknowns_ = solve::settled(rows_, *factors_, rhs_, &columns_solved_);
  } else {
    unknowns_ = factors_->solve(rhs_);
    columns_solved_ = static_cast<int>(rhs_.cols());
  }
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::value_of(int signal, const solve::RowMatrix<T>& unknowns,
                                            const solve::RowMatrix<T>& inputs) const {
  const Signal& s = data_.graph().signals[at(signal)];
  solve::RowMatrix<T> result = solve::RowMatrix<T>::Zero(s.size, inputs.cols());
  if (s.role != Signal::Role::state) {
    rows_.add_value(signal, unknowns, inputs, first_, result.data());
    return result;
  }
  if (!s.active) return result;
  const solve::BlockResponse<T>& r = *of_node_[at(s.node)];
  for (int i = data_.graph().nodes[at(s.node)].first_signal; i < signal; ++i)
    if (const Signal& in = data_.graph().signals[at(i)]; in.role == Signal::Role::input)
      result += r.X.middleCols(in.first, in.size).lazyProduct(value_of(i, unknowns, inputs));
  return result;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::value(int signal) const {
  return value_of(signal, unknowns_, u_);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::values(std::span<const int> first) const {
  return values_of(unknowns_, u_, first);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::values_of(const solve::RowMatrix<T>& unknowns,
                                             const solve::RowMatrix<T>& inputs,
                                             std::span<const int> first) const {
  const Graph& g = data_.graph();
  solve::RowMatrix<T> result = solve::RowMatrix<T>::Zero(first.back(), inputs.cols());
  for (int i = 0; i < static_cast<int>(g.signals.size()); ++i) {
    const Signal& s = g.signals[at(i)];
    if (s.role != Signal::Role::state) {
      rows_.add_value(i, unknowns, inputs, first_, result.data() + first[at(i)] * inputs.cols());
      continue;
    }
    if (!s.active) continue;
    const solve::Dense<T>& X = of_node_[at(s.node)]->X;
    for (int k = g.nodes[at(s.node)].first_signal; k < i; ++k)  // inputs come before states
      if (const Signal& in = g.signals[at(k)]; in.role == Signal::Role::input)
        result.middleRows(first[at(i)], s.size) +=
            X.middleCols(in.first, in.size).lazyProduct(result.middleRows(first[at(k)], in.size));
  }
  return result;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::outputs_of(const solve::RowMatrix<T>& unknowns,
                                              const solve::RowMatrix<T>& inputs,
                                              const solve::RowMatrix<T>* states) const {
  const Graph& g = data_.graph();
  const Layout& layout = data_.layout();
  solve::RowMatrix<T> y =
      solve::RowMatrix<T>::Zero(static_cast<Eigen::Index>(layout.outputs.size()), inputs.cols());
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (std::size_t k = 0; k < g.outputs[o].terms.size(); ++k) {
      const int signal = g.outputs[o].terms[k].signal;
      const Signal& s = g.signals[at(signal)];
      const auto& c =
          *data_.numbers.coefficients[at(data_.skeleton->joint.output_coefficient[o]) + k];
      solve::RowMatrix<T> value = value_of(signal, unknowns, inputs);
      if (states && s.role == Signal::Role::state && s.active)
        value += states->middleRows(layout.known_first[at(signal)], s.size);
      y.middleRows(layout.output_first[o], g.outputs[o].size) += lifted<T>(c).lazyProduct(value);
    }
  return y;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::outputs() const {
  return outputs_of(unknowns_, u_, nullptr);
}

template <class T>
const Resolvent<T>& Evaluation<T>::resolvent(int node) const {
  std::call_once(resolvents_once_, [&] {
    for (const int i : data_.layout().state_nodes) {
      const Dynamics& d = *data_.numbers.blocks[at(i)];
      resolvents_.try_emplace(&d, d, s_);
    }
  });
  return resolvents_.at(data_.numbers.blocks[at(node)].get());
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::own_response(const solve::RowMatrix<T>& r) const {
  solve::RowMatrix<T> own(r.rows(), r.cols());
  for (const int i : data_.layout().state_nodes) {
    const auto first = data_.layout().state_first[at(i)];
    const auto n = data_.numbers.blocks[at(i)]->A.rows();
    own.middleRows(first, n) = resolvent(i).times(r.middleRows(first, n));
  }
  return own;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::unknowns_of(const solve::RowMatrix<T>& own) const {
  std::vector<const Eigen::MatrixXd*> output;
  for (const auto& block : data_.numbers.blocks) output.push_back(&block->C);
  return factors_->solve(rows_.rhs_of_states(own, data_.layout().known_first, output));
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::forced(const solve::RowMatrix<T>& r) const {
  const solve::RowMatrix<T> own = own_response(r);
  const solve::RowMatrix<T> none = solve::RowMatrix<T>::Zero(u_.rows(), r.cols());
  return outputs_of(unknowns_of(own), none, &own);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::states() const {
  solve::RowMatrix<T> x(data_.layout().order(), u_.cols());
  for (const int i : data_.layout().state_nodes) {
    const int state = data_.graph().nodes[at(i)].state;
    x.middleRows(data_.layout().state_first[at(i)], data_.graph().signals[at(state)].size) =
        value(state);
  }
  return x;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::forced_states(const solve::RowMatrix<T>& r) const {
  solve::RowMatrix<T> x = own_response(r);
  const solve::RowMatrix<T> unknowns = unknowns_of(x);
  const solve::RowMatrix<T> none = solve::RowMatrix<T>::Zero(u_.rows(), r.cols());
  for (const int i : data_.layout().state_nodes) {
    const int state = data_.graph().nodes[at(i)].state;
    x.middleRows(data_.layout().state_first[at(i)], data_.graph().signals[at(state)].size) +=
        value_of(state, unknowns, none);
  }
  return x;
}

template class Evaluation<double>;
#define TITOP_INSTANTIATE(T) template class Evaluation<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
