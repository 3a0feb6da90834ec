#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>
#include <titop/graph/linalg/index.hpp>
#include <tuple>

namespace titop::diagram {
namespace {

using linalg::at;

/// "SpringMass ×40, Hinge ×2": the most frequent first.
std::string types(const Graph& g, const Fold::Box& box) {
  constexpr std::size_t kShown = 3;
  std::map<std::string, int> number;
  for (const int i : box.nodes) ++number[std::string(g.nodes[at(i)].block->type())];
  std::vector<std::pair<std::string, int>> list(number.begin(), number.end());
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < list.size() && i < kShown; ++i)
    text += fmt::format("{}{} ×{}", i ? ", " : "", list[i].first, list[i].second);
  return list.size() > kShown ? text + ", …" : text;
}

std::string draw_box(const Picture& p, std::size_t b) {
  const Graph& g = p.graph;
  const Fold::Box& box = p.fold.boxes[b];
  int states = 0;
  bool active = false;
  for (const int i : box.nodes) {
    if (g.nodes[at(i)].state >= 0) states += g.signals[at(g.nodes[at(i)].state)].size;
    active = active || is_active(g, i);
  }
  const std::string first = html(g.nodes[at(box.tops.front())].name);
  const std::string title =
      box.tops.size() == 1 ? first + " …" : first + " … " + html(g.nodes[at(box.tops.back())].name);
  const std::string about = fmt::format("▤ {} blocks{}, {} states<BR/>{}{}", box.nodes.size(),
                                        box.tops.size() > 1 && box.tops.size() < box.nodes.size()
                                            ? fmt::format(" in {} subtrees", box.tops.size())
                                            : "",
                                        states, html(types(g, box)), active ? "" : ", set aside");
  return fmt::format(
      "  {} [shape=box3d penwidth=1.6 margin=\"0.16,0.09\" style=\"filled{}\" fillcolor=\"{}\" "
      "color=\"{}\" label=<{}<BR/>{}>];\n",
      p.box_id[b], active ? "" : ",dashed", active ? colour::body : colour::paper,
      active ? colour::line : colour::removed,
      font(fmt::format("<B>{}</B>", title), 14, active ? colour::ink : colour::removed),
      font(about, 9, active ? colour::soft : colour::removed));
}

/// Wires, grouped by their ends and their quantity.
class Bundles {
 public:
  explicit Bundles(const Picture& p) : p_(p) {
    for (const Assignment& a : p.assignments)
      if (is_folded(p, a))
        for (const Term& t : a.terms) add(a, t);
  }

  std::string text() const {
    std::string text;
    for (const auto& [wire, number] : bundles_) {
      Wire w = wire;
      if (number > 1) w.label = fmt::format("×{}", number);
      text += draw(w);
    }
    return text;
  }

 private:
  void add(const Assignment& a, const Term& t) {
    const Graph& g = p_.graph;
    const int box = box_of(p_, a.target);
    if (box >= 0 && box == box_of(p_, t.signal)) return;  // inside
    const Anchor end = a.output >= 0 ? Anchor{p_.output_id[at(a.output)], output_side(g, a)}
                                     : anchor(p_, a.target);
    Wire w{.from = anchor(p_, t.signal).port, .to = end.port};
    w.up = end.side == BlockSide::bottom;
    w.active = a.active && g.signals[at(t.signal)].active;
    w.rows = std::max(1, rows_of(g, t));
    w.quantity = g.signals[at(a.target >= 0 ? a.target : t.signal)].quantity;
    const auto key = std::tuple(w.from, w.to, w.quantity, w.active, w.rows > 1);
    const auto [place, is_new] = found_.emplace(key, bundles_.size());
    if (is_new) bundles_.emplace_back(w, 0);
    ++bundles_[place->second].second;
  }

  const Picture& p_;
  std::vector<std::pair<Wire, int>> bundles_;
  std::map<std::tuple<std::string, std::string, Quantity, bool, bool>, std::size_t> found_;
};

}  // namespace

std::string draw_boxes(const Picture& p) {
  std::string text;
  for (std::size_t b = 0; b < p.fold.boxes.size(); ++b) text += draw_box(p, b);
  return text;
}

std::string draw_folded_wires(const Picture& p) { return Bundles(p).text(); }

}  // namespace titop::diagram
