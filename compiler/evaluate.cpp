#include <fmt/format.h>

#include <titop/compiler/evaluate.hpp>

namespace titop::detail {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

solve::Response<std::complex<double>> response(const Block& block, const Dynamics&,
                                               std::complex<double> s, ParameterValues parameters) {
  Block::Response r = block.response(s, parameters);
  return {std::move(r.X), std::move(r.Y)};
}

/// Nodes whose rows or states are in use.
std::vector<char> nodes_in_use(const Skeleton& k) {
  std::vector<char> used(k.stage.graph.nodes.size(), 0);
  for (const Row& row : k.stage.rows)
    if (row.active && row.node >= 0) used[at(row.node)] = 1;
  for (const int i : k.layout.state_nodes) used[at(i)] = 1;
  return used;
}

}  // namespace

template <class T>
solve::Matrices<T> Evaluation<T>::respond(const T& s) {
  const Graph& g = data_.graph();
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
    if (added) found->second = response(block, dynamics, s, data_.numbers.parameters);
    of_node_[at(i)] = &found->second;
    m.direct[at(i)] = &found->second.Y;
    m.states[at(i)] = &found->second.X;
  }
  return m;
}

template <class T>
Evaluation<T>::Evaluation(const SystemData& data, const T& s, const solve::RowMatrix<T>& u)
    : data_(data),
      u_(u),
      first_(data.graph().signals.size(), -1),
      rows_(data.graph(), data.skeleton->joint, data.numbers.coefficients, respond(s)) {
  const int states = static_cast<int>(data.layout().states.size());
  for (const Input& i : data.graph().inputs)
    first_[at(i.signal)] = data.layout().known_first[at(i.signal)] - states;
  const solve::Factors<T> factors(data.skeleton->joint.plan, rows_, data.factors->scale());
  if (factors.health().singular)
    throw Error(Code::singular,
                fmt::format("{} has a pole at s = {}{:+}j", data.graph().name,
                            static_cast<double>(s.real()), static_cast<double>(s.imag())),
                "evaluate beside it");
  unknowns_ = factors.solve(rows_.rhs(u_, first_));
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::value(int signal) const {
  const Signal& s = data_.graph().signals[at(signal)];
  solve::RowMatrix<T> result = solve::RowMatrix<T>::Zero(s.size, u_.cols());
  if (s.role != Signal::Role::state) {
    rows_.add_value(signal, unknowns_, u_, first_, result);
    return result;
  }
  if (!s.active) return result;
  const solve::Response<T>& r = *of_node_[at(s.node)];
  for (int i = data_.graph().nodes[at(s.node)].first_signal; i < signal; ++i)
    if (const Signal& in = data_.graph().signals[at(i)]; in.role == Signal::Role::input)
      result += r.X.middleCols(in.first, in.size) * value(i);
  return result;
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::outputs() const {
  const Graph& g = data_.graph();
  const Layout& layout = data_.layout();
  solve::RowMatrix<T> y =
      solve::RowMatrix<T>::Zero(static_cast<Eigen::Index>(layout.outputs.size()), u_.cols());
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (std::size_t k = 0; k < g.outputs[o].terms.size(); ++k) {
      const int signal = g.outputs[o].terms[k].signal;
      const auto& c =
          *data_.numbers.coefficients[at(data_.skeleton->joint.output_coefficient[o]) + k];
      y.middleRows(layout.output_first[o], g.outputs[o].size) +=
          c.template cast<T>() * value(signal);
    }
  return y;
}

template class Evaluation<std::complex<double>>;

}  // namespace titop::detail
