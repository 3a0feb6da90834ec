#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::diagram {
namespace {

using linalg::at;

template <class List>
std::vector<int> by_name(const List& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return natural_compare(list[at(a)].name, list[at(b)].name) < 0;
  });
  return order;
}

/// Blocks have their names as ids; all others have a prefix, and so have blocks whose own name
/// starts like one.
std::string block_prefix(const std::string& name) {
  for (const char* taken : {"block ", "input ", "output ", "sum ", "gain ", "ground ", "fold ",
                            "inputs of ", "outputs of "})
    if (name.starts_with(taken)) return "block ";
  return "";
}

/// Names used twice (a mistake that `check` reports) still make two nodes.
template <class List, class Prefix>
std::vector<std::string> ids(const List& list, const std::vector<int>& order, Prefix prefix) {
  std::vector<std::string> result(list.size());
  std::set<std::string> used;
  for (const int i : order) {
    const std::string name = clean(list[at(i)].name), first = prefix(name) + name;
    std::string id = first;
    for (int n = 2; !used.insert(id).second; ++n) id = fmt::format("{} ({})", first, n);
    result[at(i)] = quoted(id);
  }
  return result;
}

/// Loops of more than one signal, numbered by the first name in each.
std::vector<int> number_loops(const Stage& stage) {
  std::vector<std::pair<std::string, const Loop*>> named;
  for (const Loop& loop : stage.loops) {
    if (loop.signals.size() < 2) continue;
    std::string first;
    for (const int s : loop.signals)
      if (const std::string n = name_of(stage.now(), s);
          first.empty() || natural_compare(n, first) < 0)
        first = n;
    named.emplace_back(first, &loop);
  }
  std::sort(named.begin(), named.end(),
            [](const auto& a, const auto& b) { return natural_compare(a.first, b.first) < 0; });
  std::vector<int> number(stage.now().signals.size(), 0);
  for (std::size_t i = 0; i < named.size(); ++i)
    for (const int s : named[i].second->signals) number[at(s)] = static_cast<int>(i) + 1;
  return number;
}

/// Equations on the same part of the same signal (`=` and `+=`) add up to one assignment.
std::vector<Assignment> collect(const Graph& g, const std::vector<int>& outputs) {
  std::vector<Assignment> all;
  std::map<std::pair<int, std::string>, std::size_t> found;
  for (const Equation& e : g.equations) {
    if (e.target < 0) continue;
    const auto [place, is_new] = found.emplace(std::pair(e.target, e.part.name()), all.size());
    if (is_new)
      all.push_back({.target = e.target, .part = e.part.name(), .terms = {}, .active = e.active});
    Assignment& a = all[place->second];
    a.active = a.active || e.active;
    a.terms.insert(a.terms.end(), e.terms.begin(), e.terms.end());
  }
  const auto name = [&](const Assignment& a) { return name_of(g, a.target) + a.part; };
  std::stable_sort(all.begin(), all.end(), [&](const Assignment& a, const Assignment& b) {
    return natural_compare(name(a), name(b)) < 0;
  });
  for (const int i : outputs) all.push_back({.output = i, .terms = g.outputs[at(i)].terms});
  for (Assignment& a : all) {
    std::erase_if(a.terms, [](const Term& t) { return t.signal < 0; });  // the user's mistakes
    std::stable_sort(a.terms.begin(), a.terms.end(), [&](const Term& s, const Term& t) {
      const int c = natural_compare(name_of(g, s.signal), name_of(g, t.signal));
      return c != 0 ? c < 0 : natural_compare(print(g, s), print(g, t)) < 0;
    });
  }
  return all;
}

/// Ports that are simply 0. An acceleration of a channel is drawn as ground instead.
std::vector<std::string> find_zeros(const Graph& g, const std::vector<Assignment>& assignments) {
  std::vector<std::string> zero(g.signals.size());
  std::vector<char> driven(g.signals.size(), 0);
  for (const Assignment& a : assignments) {
    if (a.target < 0) continue;
    const Signal& s = g.signals[at(a.target)];
    driven[at(a.target)] = 1;
    if (s.channel >= 0) {
      driven[at(g.channels[at(s.channel)].accel)] = driven[at(g.channels[at(s.channel)].force)] = 1;
      if (s.quantity == Quantity::acceleration) continue;
    }
    if (a.terms.empty()) zero[at(a.target)] = (a.part.empty() ? "" : " ") + a.part + " = 0";
  }
  for (const Channel& c : g.channels)  // child channel without equation: nothing is mounted
    if (c.takes == Takes::force && !driven[at(c.force)]) zero[at(c.force)] = " = 0";
  return zero;
}

/// Inputs that drive one box alone, and outputs that read one alone, share an ellipse.
void share_ends(Picture& p) {
  constexpr int kNone = -1, kMany = -2;
  std::vector<int> input(p.graph.inputs.size(), kNone), output(p.graph.outputs.size(), kNone);
  const auto meet = [](int& place, int box) {
    place = box < 0 || (place != kNone && place != box) ? kMany : box;
  };
  for (const Assignment& a : p.assignments)
    for (const Term& t : a.terms) {
      if (a.output >= 0) meet(output[at(a.output)], box_of(p, t.signal));
      if (p.graph.signals[at(t.signal)].role == Signal::Role::external)
        meet(input[at(p.graph.signals[at(t.signal)].spec)], box_of(p, a.target));
    }
  const auto share = [&](const std::vector<int>& box, std::vector<std::string>& id,
                         const char* subject) {
    for (std::size_t b = 0; b < p.box_id.size(); ++b)
      if (std::count(box.begin(), box.end(), static_cast<int>(b)) > 1)
        for (std::size_t i = 0; i < box.size(); ++i)
          if (box[i] == static_cast<int>(b))
            id[i] = quoted(fmt::format(
                "{} of {}", subject, clean(p.graph.nodes[at(p.fold.boxes[b].nodes.front())].name)));
  };
  share(input, p.input_id, "inputs");
  share(output, p.output_id, "outputs");
}

}  // namespace

Picture picture(const Stage& stage, int most) {
  const Graph& g = stage.now();
  Picture p{stage, g,  {}, {}, {}, by_name(g.nodes), by_name(g.inputs), by_name(g.outputs), {},
            {},    {}, {}, {}, {}};
  p.node_id = ids(g.nodes, p.nodes, block_prefix);
  p.input_id = ids(g.inputs, p.inputs, [](const std::string&) { return std::string("input "); });
  p.output_id =
      ids(g.outputs, p.outputs, [](const std::string&) { return std::string("output "); });
  p.loop = number_loops(stage);
  p.inverted.assign(g.channels.size(), 0);
  for (const Inversion& i : stage.inversions)
    if (i.channel >= 0) p.inverted[at(i.channel)] = 1;
  p.assignments = collect(g, p.outputs);
  p.zero = find_zeros(g, p.assignments);
  p.fold = fold(g, most);
  for (const Fold::Box& box : p.fold.boxes)
    p.box_id.push_back(quoted("fold " + clean(g.nodes[at(box.nodes.front())].name)));
  share_ends(p);
  return p;
}

int box_of(const Picture& p, int signal) {
  const int node = signal < 0 ? -1 : p.graph.signals[at(signal)].node;
  return node < 0 ? -1 : p.fold.box_of[at(node)];
}

bool is_folded(const Picture& p, const Assignment& a) {
  return box_of(p, a.target) >= 0 ||
         std::any_of(a.terms.begin(), a.terms.end(),
                     [&](const Term& t) { return box_of(p, t.signal) >= 0; });
}

BlockSide output_side(const Graph& g, const Assignment& a) {
  for (const Term& t : a.terms)
    if (side_of(g, t.signal) != BlockSide::top) return BlockSide::top;
  return a.terms.empty() ? BlockSide::top : BlockSide::bottom;
}

bool is_active(const Graph& g, int node) {
  const int first = g.nodes[at(node)].first_signal, end = end_signal(g, node);
  for (int s = first; s < end; ++s)
    if (g.signals[at(s)].active) return true;
  return first == end;
}

BlockSide side_of(const Graph& g, int signal) {
  const Signal& s = g.signals[at(signal)];
  if (s.role == Signal::Role::external) return BlockSide::loose;
  if (s.channel < 0) return s.role == Signal::Role::input ? BlockSide::top : BlockSide::bottom;
  const Channel& c = g.channels[at(s.channel)];
  const auto& spec = g.nodes[at(c.node)].block->interface().channels[at(c.spec)];
  // A joint's own axis has no parent: the block that drives it (a motor, a spring) is drawn below.
  return c.takes == Takes::accel && !spec.name.empty() ? BlockSide::top : BlockSide::bottom;
}

std::string cell_name(const Graph& g, int signal) {
  const Signal& s = g.signals[at(signal)];
  if (s.channel >= 0)
    return fmt::format("c{}{}", s.spec, s.quantity == Quantity::acceleration ? 'a' : 'f');
  if (s.role == Signal::Role::state) return "x";
  return fmt::format("{}{}", s.role == Signal::Role::input ? 'i' : 'o', s.spec);
}

Anchor anchor(const Picture& p, int signal) {
  const Signal& s = p.graph.signals[at(signal)];
  const BlockSide side = side_of(p.graph, signal);
  if (s.role == Signal::Role::external) return {p.input_id[at(s.spec)], side};
  if (const int box = p.fold.box_of[at(s.node)]; box >= 0) return {p.box_id[at(box)], side};
  const char compass = s.role == Signal::Role::state ? 'e' : side == BlockSide::top ? 'n' : 's';
  return {fmt::format("{}:{}:{}", p.node_id[at(s.node)], cell_name(p.graph, signal), compass),
          side};
}

}  // namespace titop::diagram
