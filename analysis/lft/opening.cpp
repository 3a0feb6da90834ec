#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <titop/analysis/lft/opening.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;
using Kind = ParameterRange::Kind;

/// Parameters that are angles of rotations in equations and outputs.
std::vector<char> angles_of(const Graph& g) {
  std::vector<char> result(g.parameters.size(), 0);
  const auto look = [&](const std::vector<Term>& terms) {
    for (const Term& t : terms)
      for (const Factor& f : t.factors)
        if (const auto* T = std::get_if<Rotation>(&f))
          for (const Value& v : T->values())
            if (v.is_parameter()) result[at(v.index())] = 1;
  };
  for (const Equation& e : g.equations) look(e.terms);
  for (const Output& y : g.outputs) look(y.terms);
  return result;
}

/// Reads the ranges one by one; mistakes are collected.
struct RangeReader {
  const System& system;
  const ParameterList all = system.parameters();
  const std::vector<char> angle = angles_of(*system.stage().source);
  std::vector<Mistake> mistakes = {};

  void refuse(Code code, std::string message, std::string hint) {
    mistakes.push_back({code, std::move(message), {}, std::move(hint)});
  }

  /// -1 if there is no such parameter.
  int index_of(const std::string& name) {
    std::string known;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].first == name) return static_cast<int>(i);
      known += (known.empty() ? "" : ", ") + all[i].first;
    }
    refuse(Code::unknown_name,
           fmt::format("{} has no parameter {}", system.stage().graph.name, name),
           known.empty() ? "make one with Diagram::param" : "its parameters are " + known);
    return -1;
  }

  /// The block or the passes refuse the value at an end.
  void try_end(const std::string& name, double value) {
    try {
      system.update({{name, value}});
    } catch (const Error& error) {
      for (const Mistake& m : error.mistakes())
        mistakes.push_back(
            {Code::bad_value,
             fmt::format("{} = {:.6g}, an end of its range: {}", name, value, m.message), m.details,
             "give a range all of which makes a model; " + m.hint});
    }
  }

  std::optional<ParameterMap> map(const std::string& name, int index, const ParameterRange& r) {
    const double nominal = all[at(index)].second, pi = std::numbers::pi;
    const bool turns = angle[at(index)] != 0;
    if (r.kind == Kind::full_turn) {
      if (turns)
        return ParameterMap(ParameterMap::Kind::quarter_angle, nominal, nominal - pi, nominal + pi);
      refuse(Code::bad_value, fmt::format("{} is no angle of a rotation", name),
             "full_turn is for angles; give percent or between");
      return {};
    }
    const double part = std::abs(nominal) * r.first / 100;
    const bool share = r.kind == Kind::percent;
    const double from = share ? nominal - part : r.first, to = share ? nominal + part : r.second;
    if (!(from < nominal && nominal < to) || !std::isfinite(to - from)) {
      refuse(Code::bad_value,
             fmt::format("{} = {:.6g} is not inside of its range, {:.6g} to {:.6g}", name, nominal,
                         from, to),
             "give between(least, largest) around the value that the system has; update the system "
             "for another one");
      return {};
    }
    if (turns && std::max(to - nominal, nominal - from) >= pi) {
      refuse(Code::bad_value,
             fmt::format("{} reaches half a turn from {:.6g} rad: {:.6g} to {:.6g}", name, nominal,
                         from, to),
             "give full_turn(), at twice as many occurrences, or a smaller range");
      return {};
    }
    return ParameterMap(turns ? ParameterMap::Kind::half_angle : ParameterMap::Kind::number,
                        nominal, from, to);
  }
};

/// Columns of the input (or rows of the output) of this name.
std::vector<Index> places(const std::vector<std::string>& names, const std::string& name,
                          int size) {
  const std::string first = size == 1 ? name : name + "(1)";
  const auto found = std::find(names.begin(), names.end(), first) - names.begin();
  std::vector<Index> result(at(size));
  std::iota(result.begin(), result.end(), static_cast<Index>(found));
  return result;
}

std::vector<std::string> named(const std::vector<std::string>& names,
                               const std::vector<Index>& order) {
  std::vector<std::string> result;
  for (const Index i : order) result.push_back(names[at(i)]);
  return result;
}

/// The port of this name.
template <class List>
int port(const List& list, const std::string& name) {
  return static_cast<int>(
      std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.name == name; }) -
      list.begin());
}

/// The ports that are in none of these lists, in declared order.
template <class List>
std::vector<int> other_ports(const List& list, const std::vector<OpenedPorts>& taken,
                             std::vector<int> OpenedPorts::*of) {
  std::vector<char> is_taken(list.size(), 0);
  for (const OpenedPorts& p : taken)
    for (const int i : p.*of) is_taken[at(i)] = 1;
  std::vector<int> result;
  for (int i = 0; i < static_cast<int>(list.size()); ++i)
    if (!is_taken[at(i)]) result.push_back(i);
  std::sort(result.begin(), result.end(),
            [&](int a, int b) { return list[at(a)].declared < list[at(b)].declared; });
  return result;
}

/// Appends the places that are not in the list.
void add_others(std::vector<Index>& order, std::size_t all) {
  std::vector<char> taken(all, 0);
  for (const Index i : order) taken[at(i)] = 1;
  for (std::size_t i = 0; i < all; ++i)
    if (!taken[i]) order.push_back(static_cast<Index>(i));
}

/// Corners of the box in the parameters of one block that it refuses, though it takes each end by
/// itself: two products of inertia that are too large together. The first of every block. Of more
/// than 2^12 corners those whose last parameters are at their least values.
class Corners {
 public:
  Corners(const System& system, const std::vector<IsolatedParameter>& ranged)
      : names_(system.parameters()), ranged_(ranged) {
    for (const auto& [name, value] : names_) nominal_.push_back(value);
    for (const Node& node : system.stage().source->nodes) try_block(node);
  }
  std::vector<Mistake> mistakes;

 private:
  std::vector<const IsolatedParameter*> of_block(const Block& block) const {
    const std::vector<Value> all = block.values();
    std::vector<const IsolatedParameter*> result;
    for (const IsolatedParameter& p : ranged_)
      if (std::any_of(all.begin(), all.end(),
                      [&](const Value& v) { return v.is_parameter() && v.index() == p.index; }))
        result.push_back(&p);
    return result;
  }

  void try_block(const Node& node) {
    constexpr std::size_t kMost = 12;
    const auto own = of_block(*node.block);
    if (own.size() < 2) return;  // its ends have been tried
    const long corners = 1L << std::min(own.size(), kMost);
    for (long c = 0; c < corners; ++c) {
      std::vector<double> values = nominal_;
      std::string where;
      for (std::size_t i = 0; i < own.size(); ++i) {
        const ParameterMap& map = own[i]->map;
        const double value = i < kMost && (c >> i & 1) != 0 ? map.to : map.from;
        values[at(own[i]->index)] = value;
        where +=
            fmt::format("{}{} = {:.6g}", i > 0 ? ", " : "", names_[at(own[i]->index)].first, value);
      }
      try {
        node.block->dynamics(values);
      } catch (const Error& error) {
        const Mistake& m = error.mistakes().front();
        mistakes.push_back(
            {Code::bad_value,
             fmt::format("{}, ends of their ranges together: {}: {}", where, node.name, m.message),
             m.details, "give smaller ranges, all of which make a model; " + m.hint});
        return;
      }
    }
  }

  const ParameterList names_;
  const std::vector<IsolatedParameter>& ranged_;
  std::vector<double> nominal_;
};

}  // namespace

IsolatedParameter unranged(const System& system, const std::string& name,
                           std::vector<Mistake>& mistakes) {
  RangeReader reader{system};
  const int index = reader.index_of(name);
  mistakes.insert(mistakes.end(), reader.mistakes.begin(), reader.mistakes.end());
  const bool angle = index >= 0 && reader.angle[at(index)];
  const double nominal = index < 0 ? 0 : reader.all[at(index)].second;
  return {index, ParameterMap(angle ? ParameterMap::Kind::half_angle : ParameterMap::Kind::number,
                              nominal, nominal - 1, nominal + 1)};
}

std::vector<IsolatedParameter> isolated(const System& system, const ParameterRanges& ranges) {
  RangeReader reader{system};
  std::vector<IsolatedParameter> result;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const auto& [name, range] = ranges[i];
    if (std::any_of(ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const auto& other) { return other.first == name; })) {
      reader.refuse(Code::duplicate_name, fmt::format("parameter {} has two ranges", name),
                    "keep one of them");
      continue;
    }
    const int index = reader.index_of(name);
    if (index < 0) continue;
    const auto map = reader.map(name, index, range);
    if (!map) continue;
    result.push_back({index, *map});
    if (map->kind != ParameterMap::Kind::number) continue;
    reader.try_end(name, map->from);
    reader.try_end(name, map->to);
  }
  if (reader.mistakes.empty()) reader.mistakes = Corners(system, result).mistakes;
  if (!reader.mistakes.empty()) throw Error(std::move(reader.mistakes));
  return result;
}

OpenedMatrices opened_matrices(const System& opened,
                               const std::vector<IsolatedParameter>& parameters) {
  StateSpace m;
  opened.write(m);
  OpenedMatrices result;
  std::vector<Index> in, out;
  const Graph& g = opened.stage().graph;
  for (const IsolatedParameter& p : parameters) {
    result.sizes.push_back(0);
    result.where.emplace_back();
    result.ports.emplace_back();
    for (const OpenedPairs& pairs : opened.stage().opened) {
      if (pairs.parameter != p.index) continue;
      result.sizes.back() += pairs.size;
      auto& where = result.where.back();
      if (std::find(where.begin(), where.end(), pairs.where) == where.end())
        where.push_back(pairs.where);
      result.ports.back().inputs.push_back(port(g.inputs, pairs.name));
      result.ports.back().outputs.push_back(port(g.outputs, pairs.name));
      const auto w = places(m.inputs, pairs.name, pairs.size),
                 z = places(m.outputs, pairs.name, pairs.size);
      in.insert(in.end(), w.begin(), w.end());
      out.insert(out.end(), z.begin(), z.end());
    }
  }
  result.ports.push_back({other_ports(g.inputs, result.ports, &OpenedPorts::inputs),
                          other_ports(g.outputs, result.ports, &OpenedPorts::outputs)});
  add_others(in, m.inputs.size());
  add_others(out, m.outputs.size());
  result.in = in, result.out = out;
  result.m.A = m.A;
  result.m.B = m.B(Eigen::all, in);
  result.m.C = m.C(out, Eigen::all);
  result.m.D = m.D(out, in);
  result.m.states = m.states;
  result.m.inputs = named(m.inputs, in);
  result.m.outputs = named(m.outputs, out);
  return result;
}

}  // namespace titop::detail
