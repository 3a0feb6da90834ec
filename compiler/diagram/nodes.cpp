#include <fmt/format.h>

#include <cmath>
#include <set>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::diagram {
namespace {

using linalg::at;

bool knows_parameters(const Stage& stage, const Block& block) {
  for (const Value& v : block.values())
    if (v.is_parameter() && v.index() >= static_cast<int>(stage.values.size())) return false;
  return true;
}

/// Coefficient of this input in a sum or a gain: " +", " −", " × 12", " × k1".
std::string coefficient_text(const Picture& p, int signal) {
  const Signal& u = p.graph.signals[at(signal)];
  const Block& block = *p.graph.nodes[at(u.node)].block;
  const Interface& face = block.interface();
  if (u.role != Signal::Role::input || !block.is_algebraic() || face.outputs.size() != 1 ||
      !knows_parameters(p.stage, block))
    return {};
  const auto values = block.values();
  if (values.size() == 1 && face.inputs.size() == 1 && values[0].is_parameter()) {
    const double scale = values[0].scale();
    return fmt::format(" × {}{}{}", scale < 0 ? "−" : "",
                       std::abs(scale) == 1 ? "" : fmt::format("{:.4g} ", std::abs(scale)),
                       p.graph.parameters[at(values[0].index())].name);
  }
  const auto dynamics = block.dynamics(p.stage.values);
  const auto D = dynamics->D.middleCols(u.first, u.size);
  if (D.rows() != D.cols() || !D.isDiagonal(0) || (D.diagonal().array() != D(0, 0)).any())
    return fmt::format(" × M {}×{}", D.rows(), D.cols());
  if (D(0, 0) == 1) return face.inputs.size() > 1 ? " +" : "";
  return D(0, 0) == -1 ? " −" : fmt::format(" × {:.4g}", D(0, 0));
}

/// A cell for one signal: its name, the reason if it is 0, the number of its loop.
std::string cell(const Picture& p, int signal, const std::string& name, bool two_rows) {
  const Signal& s = p.graph.signals[at(signal)];
  const int loop = p.loop[at(signal)];
  std::string text = html(name);
  if (const std::string k = coefficient_text(p, signal); !k.empty())
    text += font(html(k), 10, s.active ? colour::ink : colour::removed);
  if (!p.zero[at(signal)].empty())
    text += font(html(p.zero[at(signal)]), 9, s.active ? colour::soft : colour::removed);
  if (loop > 0) text += font(fmt::format(" <B>↻{}</B>", loop), 9, colour::loop_line(loop));
  if (!s.active) text = font(text, 10, colour::removed);
  return fmt::format(
      R"(<TD PORT="{}"{}{}>{}</TD>)", cell_name(p.graph, signal), two_rows ? R"( ROWSPAN="2")" : "",
      loop > 0 ? fmt::format(R"( BGCOLOR="{}")", colour::loop_fill(loop)) : "", text);
}

/// The head over a channel's pair of cells. An inverted one is white on dark, with the paper's -1.
std::string head(const Picture& p, int channel, const std::string& name) {
  const Channel& c = p.graph.channels[at(channel)];
  const bool active = p.graph.signals[at(c.accel)].active || p.graph.signals[at(c.force)].active;
  if (p.inverted[at(channel)])
    return fmt::format(R"(<TD COLSPAN="2" BGCOLOR="{}">{}</TD>)", colour::line,
                       font(fmt::format("<B>{} ⁻¹</B>", html(name)), 10, colour::paper));
  return fmt::format(R"(<TD COLSPAN="2">{}</TD>)", font(fmt::format("<B>{}</B>", html(name)), 10,
                                                        active ? colour::ink : colour::removed));
}

/// One side of a block: heads and pairs of its channels, then its one-way ports.
class PortRow {
 public:
  PortRow(const Picture& p, int node, BlockSide side) : p_(p) {
    const Graph& g = p.graph;
    for (int s = g.nodes[at(node)].first_signal; s < end_signal(g, node); ++s) {
      const Signal& signal = g.signals[at(s)];
      if (signal.role == Signal::Role::state || side_of(g, s) != side) continue;
      if (signal.channel < 0)
        one_way_.push_back(s);
      else if (g.channels[at(signal.channel)].accel == s)
        channels_.push_back(signal.channel);
    }
  }

  bool empty() const { return channels_.empty() && one_way_.empty(); }

  std::string table(BlockSide side) const {
    std::string heads, pairs, singles;
    bool named = false;
    for (const int c : channels_) named = named || !spec(c).name.empty();
    for (const int c : channels_) add(c, named, heads, pairs, singles);
    for (const int s : one_way_) singles += cell(p_, s, port_name(s), named);
    const bool pairs_first = side == BlockSide::top;
    std::string rows = fmt::format("<TR>{}{}</TR>", pairs_first ? pairs : heads, singles);
    if (named) rows += fmt::format("<TR>{}</TR>", pairs_first ? heads : pairs);
    return fmt::format(
        "      <TR><TD><TABLE BORDER=\"0\" CELLBORDER=\"1\" CELLSPACING=\"0\" "
        "CELLPADDING=\"3\">{}</TABLE></TD></TR>\n",
        rows);
  }

 private:
  const ChannelSpec& spec(int channel) const {
    const Channel& c = p_.graph.channels[at(channel)];
    return p_.graph.nodes[at(c.node)].block->interface().channels[at(c.spec)];
  }

  std::string port_name(int signal) const {
    const Signal& s = p_.graph.signals[at(signal)];
    const Interface& face = p_.graph.nodes[at(s.node)].block->interface();
    return (s.role == Signal::Role::input ? face.inputs : face.outputs)[at(s.spec)].name;
  }

  /// A channel without a name (a joint's own axis) has no head: its cells suffice.
  void add(int channel, bool named, std::string& heads, std::string& pairs,
           std::string& singles) const {
    const Channel& c = p_.graph.channels[at(channel)];
    const bool headless = spec(channel).name.empty();
    const std::string mark = headless && p_.inverted[at(channel)] ? " ⁻¹" : "";
    const std::string both = cell(p_, c.accel, spec(channel).accel_name, headless && named) +
                             cell(p_, c.force, spec(channel).force_name + mark, headless && named);
    (headless ? singles : pairs) += both;
    if (!headless) heads += head(p_, channel, spec(channel).name);
  }

  const Picture& p_;
  std::vector<int> channels_, one_way_;
};

/// Name, type, number of states; grey if it has been set aside.
std::string title(const Graph& g, int node, bool active) {
  const Node& n = g.nodes[at(node)];
  std::string about = html(n.block->type());
  if (n.state >= 0) {
    const int states = g.signals[at(n.state)].size;
    about += fmt::format(", {} state{}", states, states == 1 ? "" : "s");
    if (active && !g.signals[at(n.state)].active) about += " set aside";
  }
  if (!active) about += ", set aside";
  const std::string_view fill = !active                                 ? colour::paper
                                : n.block->interface().channels.empty() ? colour::controller
                                                                        : colour::body;
  return fmt::format(
      "      <TR><TD PORT=\"x\" BGCOLOR=\"{}\" CELLPADDING=\"5\">{}<BR/>{}</TD></TR>\n", fill,
      font(fmt::format("<B>{}</B>", html(n.name)), 14, active ? colour::ink : colour::removed),
      font(about, 9, active ? colour::soft : colour::removed));
}

std::string draw_block(const Picture& p, int node) {
  const bool active = is_active(p.graph, node);
  const PortRow top(p, node, BlockSide::top), bottom(p, node, BlockSide::bottom);
  return fmt::format(
      "  {} [shape=plain label=<\n"
      "    <TABLE BORDER=\"{}\"{} CELLBORDER=\"0\" CELLSPACING=\"0\" CELLPADDING=\"0\" "
      "BGCOLOR=\"{}\" COLOR=\"{}\">\n{}{}{}    </TABLE>>];\n",
      p.node_id[at(node)], active ? 2 : 1, active ? "" : R"( STYLE="dashed")", colour::paper,
      active ? colour::line : colour::removed, top.empty() ? "" : top.table(BlockSide::top),
      title(p.graph, node, active), bottom.empty() ? "" : bottom.table(BlockSide::bottom));
}

std::string with_size(const std::string& name, int size) {
  return size == 1 ? html(name) : html(name) + " " + font(fmt::format("{}", size), 9, colour::soft);
}

/// External inputs or outputs; those that share an ellipse by first and last name.
template <class List>
std::string draw_ends(const List& list, const std::vector<int>& order,
                      const std::vector<std::string>& id, const char* look) {
  std::string text;
  std::set<std::string> drawn;
  for (const int i : order) {
    if (!drawn.insert(id[at(i)]).second) continue;
    std::string label = with_size(list[at(i)].name, list[at(i)].size);
    int last = i, number = 0;
    for (const int k : order)
      if (id[at(k)] == id[at(i)]) last = k, ++number;
    if (number > 1)
      label = fmt::format("{} … {} {}", html(list[at(i)].name), html(list[at(last)].name),
                          font(fmt::format("({})", number), 9, colour::soft));
    text += fmt::format("  {} [shape=ellipse {} label=<{}>];\n", id[at(i)], look, label);
  }
  return text;
}

}  // namespace

std::string draw_nodes(const Picture& p) {
  std::string text = draw_ends(p.graph.inputs, p.inputs, p.input_id, "penwidth=1.6");
  for (const int i : p.nodes)
    if (p.fold.box_of[at(i)] < 0) text += draw_block(p, i);
  return text + draw_boxes(p) + draw_ends(p.graph.outputs, p.outputs, p.output_id, "peripheries=2");
}

}  // namespace titop::diagram
