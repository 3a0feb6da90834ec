#include <fmt/format.h>

#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::diagram {
namespace {

using linalg::at;

std::string head_shape(const Wire& w) {
  if (!w.arrow) return "none";
  return w.quantity == Quantity::acceleration ? "normal"
         : w.quantity == Quantity::force      ? "onormal"
                                              : "vee";
}

}  // namespace

std::string draw(const Wire& w) {
  std::string text = fmt::format("  {} -> {} [", w.up ? w.to : w.from, w.up ? w.from : w.to);
  text += w.up ? fmt::format("dir=back arrowtail={}", head_shape(w))
               : fmt::format("arrowhead={}", head_shape(w));
  if (w.rows > 1 || w.loop > 0)
    text += fmt::format(" penwidth={}", (w.rows > 1 ? 1.9 : 1.0) + (w.loop > 0 ? 0.6 : 0));
  if (w.rows > 1) text += " arrowsize=0.9";
  if (!w.active)
    text += fmt::format(" style=dashed color={0} fontcolor={0}", quoted(colour::removed));
  else if (w.loop > 0)
    text += fmt::format(" color={}", quoted(colour::loop_line(w.loop)));
  if (!w.label.empty()) text += fmt::format(" label={}", quoted(" " + w.label + " "));
  if (w.minus)
    text += fmt::format(" {}=\"−\" labelfontsize=16 labeldistance=1.3 labelfontcolor={}",
                        w.up ? "taillabel" : "headlabel",
                        quoted(w.active ? colour::ink : colour::removed));
  return text + "];\n";
}

namespace {

/// Draws the terms that drive one port or output: a sum if there are several, and for each term a
/// small node for its gain or rotation.
class Drawing {
 public:
  Drawing(const Picture& p, const Assignment& a) : p_(p), a_(a) {
    const Graph& g = p.graph;
    name_ = a.output >= 0 ? g.outputs[at(a.output)].name : name_of(g, a.target);
    name_ = (a.output >= 0 ? "output " : "") + clean(name_) + a.part;
    end_ =
        a.output >= 0 ? Anchor{p.output_id[at(a.output)], output_side(g, a)} : anchor(p, a.target);
    hub_ = a.terms.size() > 1 ? quoted("sum " + name_) : end_.port;
  }

  std::string text() {
    if (a_.terms.empty()) return ground();
    if (a_.terms.size() > 1) sum();
    for (std::size_t i = 0; i < a_.terms.size(); ++i) term(a_.terms[i], static_cast<int>(i));
    return text_;
  }

 private:
  bool up_into_end() const { return end_.side == BlockSide::bottom; }

  /// Quantity of a term at its block, and of the signal that it drives.
  Quantity read_as(const Term& t) const {
    return t.of == Term::Of::rate       ? Quantity::velocity
           : t.of == Term::Of::position ? Quantity::position
                                        : p_.graph.signals[at(t.signal)].quantity;
  }
  Quantity quantity(const Term& t) const {
    return a_.target >= 0 ? p_.graph.signals[at(a_.target)].quantity : read_as(t);
  }

  int loop(const Term& t) const {
    if (a_.target < 0) return 0;
    const int here = p_.loop[at(a_.target)];
    return here > 0 && here == p_.loop[at(t.signal)] ? here : 0;
  }

  /// The ground, the only constant that is drawn: a motion of 0.
  std::string ground() const {
    if (a_.target < 0) return {};
    const Signal& s = p_.graph.signals[at(a_.target)];
    if (s.channel < 0 || s.quantity != Quantity::acceleration) return {};
    const std::string id = quoted("ground " + name_);
    const bool active = is_active(p_.graph, s.node);
    const std::string hatch = font("<B>╱╱╱╱╱</B>", 9, active ? colour::line : colour::removed);
    const bool above = !up_into_end();
    const std::string symbol =
        fmt::format(R"(<TABLE BORDER="0" CELLBORDER="2" CELLSPACING="0" CELLPADDING="0"><TR>)"
                    R"(<TD SIDES="{}">{}</TD></TR></TABLE>)",
                    above ? "B" : "T", hatch);
    Wire w{.from = id, .to = end_.port, .up = !above, .arrow = false, .active = active};
    w.rows = s.size;
    w.label = a_.part;
    return fmt::format("  {} [shape=plain label=<{}>];\n", id, symbol) + draw(w);
  }

  void sum() {
    bool active = false;
    for (const Term& t : a_.terms) active = active || alive(t);
    const Term& first = a_.terms.front();
    text_ += fmt::format("  {} [shape=circle label=\"+\" width=0.24 fixedsize=true{}];\n", hub_,
                         active ? "" : grey());
    Wire w{.from = hub_, .to = end_.port, .up = up_into_end(), .active = active};
    w.rows = rows_of(p_.graph, first);
    for (const Term& t : a_.terms)
      if (w.loop == 0) w.loop = loop(t);
    w.quantity = quantity(first);
    text_ += draw(w);
  }

  bool alive(const Term& t) const { return a_.active && p_.graph.signals[at(t.signal)].active; }

  static std::string grey() {
    return fmt::format(" style=dashed color={0} fontcolor={0}", quoted(colour::removed));
  }

  /// A small node on the wire, or "" if the wire may run straight. Between two ports on the same
  /// side of their blocks a point keeps the wire out of the blocks.
  std::string way(const Term& t, const Look& l, BlockSide from, int number) {
    const bool single = a_.terms.size() == 1;
    const std::string sign = single && l.minus ? "−" : "";
    const std::string id = quoted(
        a_.terms.size() == 1 ? "gain " + name_ : fmt::format("gain {} {}", name_, number + 1));
    const std::string look = alive(t) ? "" : grey();
    if (!l.box.empty() || !sign.empty()) {
      text_ += fmt::format("  {} [shape=box{} label={}{}];\n", id,
                           l.rotation || !look.empty() ? "" : " style=rounded",
                           quoted(l.box.empty() ? sign + "1" : sign + l.box), look);
      return id;
    }
    if (!single || from == BlockSide::loose || from != end_.side) return {};
    text_ += fmt::format("  {} [shape=point width=0.03];\n", id);
    return id;
  }

  void term(const Term& t, int number) {
    const Look l = look(p_, a_, t);
    const Anchor from = anchor(p_, t.signal);
    const bool single = a_.terms.size() == 1;
    Wire w{.from = from.port, .to = hub_, .active = alive(t), .loop = loop(t)};
    w.quantity = quantity(t);
    w.minus = !single && l.minus;
    w.label = l.before;
    const std::string mid = way(t, l, from.side, number);
    const bool up_out = from.side == BlockSide::loose ? up_into_end() : from.side == BlockSide::top;
    if (mid.empty()) {
      w.up = single ? up_into_end() : up_out;
      w.rows = l.rows;
      text_ += draw(w);
      return;
    }
    Wire first = w;
    first.to = mid;
    first.up = up_out;
    first.minus = false;
    first.rows = p_.graph.signals[at(t.signal)].size;
    first.arrow = !l.box.empty() || l.minus;
    first.quantity = read_as(t);
    w.from = mid;
    w.up = single ? up_into_end() : up_out;
    w.rows = l.rows;
    w.label = l.after;
    text_ += draw(first) + draw(w);
  }

  const Picture& p_;
  const Assignment& a_;
  std::string name_, hub_, text_;
  Anchor end_;
};

}  // namespace

std::string draw_wires(const Picture& p) {
  std::string text;
  for (const Assignment& a : p.assignments) {
    // Rows of a block that `lower` made a coefficient: the block itself shows them.
    if (a.target >= 0 && !a.terms.empty()) {
      const int node = p.graph.signals[at(a.target)].node;
      if (node >= 0 && p.graph.nodes[at(node)].lowered &&
          p.graph.signals[at(a.target)].role == Signal::Role::output)
        continue;
    }
    if (is_folded(p, a)) continue;
    text += Drawing(p, a).text();
  }
  return text;
}

}  // namespace titop::diagram
