#include <algorithm>
#include <map>
#include <numeric>
#include <titop/graph/graph.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/name_order.hpp>

namespace titop {
namespace {

using linalg::at;

/// False if the names are not unique.
bool order_of(const std::vector<std::string>& names, Eigen::Index count, std::vector<int>& order) {
  if (static_cast<Eigen::Index>(names.size()) != count) return false;
  order.resize(names.size());
  std::iota(order.begin(), order.end(), 0);
  const auto less = [&](int a, int b) { return natural_compare(names[at(a)], names[at(b)]) < 0; };
  std::sort(order.begin(), order.end(), less);
  return std::adjacent_find(order.begin(), order.end(),
                            [&](int a, int b) { return !less(a, b); }) == order.end();
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> result(order.size());
  for (int i = 0; i < static_cast<int>(order.size()); ++i) result[at(order[at(i)])] = i;
  return result;
}

}  // namespace

std::vector<std::string> names_at(const std::vector<std::string>& names,
                                  const std::vector<int>& places) {
  std::vector<std::string> result;
  if (!names.empty())
    for (const int i : places) result.push_back(names[at(i)]);
  return result;
}

std::optional<NameOrder> name_order(const StateSpace& m) {
  NameOrder order;
  if (!order_of(m.states, m.A.rows(), order.states) ||
      !order_of(m.inputs, m.B.cols(), order.inputs) ||
      !order_of(m.outputs, m.C.rows(), order.outputs))
    return std::nullopt;
  return order;
}

StateSpace by_name(const StateSpace& m, const NameOrder& order) {
  const auto& [x, u, y] = order;
  return {m.A(x, x),
          m.B(x, u),
          m.C(y, x),
          m.D(y, u),
          names_at(m.states, x),
          names_at(m.inputs, u),
          names_at(m.outputs, y),
          names_at(m.rates, x)};
}

StateSpace states_by_name(const StateSpace& m) {
  std::vector<int> x;
  if (!order_of(m.states, m.A.rows(), x)) return m;
  return {m.A(x, x), m.B(x, Eigen::all), m.C(Eigen::all, x),  m.D, names_at(m.states, x),
          m.inputs,  m.outputs,          names_at(m.rates, x)};
}

StateSpace as_before(const StateSpace& m, const std::vector<std::string>& states,
                     const NameOrder& order) {
  std::map<std::string, int> position;
  for (int i = 0; i < static_cast<int>(m.states.size()); ++i) position.emplace(m.states[at(i)], i);
  NameOrder back{{}, inverse(order.inputs), inverse(order.outputs)};
  for (const std::string& name : states)
    if (const auto it = position.find(name); it != position.end())
      back.states.push_back(it->second);
  return by_name(m, back);
}

}  // namespace titop
