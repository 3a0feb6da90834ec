#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <titop/compiler/diagram/dot.hpp>
#include <titop/emit/report/drawing.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>
#include <titop/emit/report/written.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::report {
namespace {

using linalg::at;

constexpr std::size_t kRows = 60;  ///< of a table; more are counted

std::string more(std::size_t all, const char* item) {
  return all <= kRows
             ? ""
             : fmt::format("<p class=\"note\">{} more {} are not listed.</p>\n", all - kRows, item);
}

/// "[N; N m]" over the scalars of one signal.
std::string units_of(const std::vector<ScalarSignal>& scalars, const std::string& signal) {
  std::vector<std::string> units;
  for (const ScalarSignal& s : scalars)
    if (s.signal == signal && (units.empty() || units.back() != or_users(s.unit)))
      units.push_back(or_users(s.unit));
  return fmt::format("{}", fmt::join(units, "; "));
}

template <class List, class Words>
std::string ports(const List& list, const std::vector<ScalarSignal>& scalars, const char* verb,
                  Words words) {
  if (list.empty()) return fmt::format("<p>The scene has no {}s.</p>\n", verb);
  std::vector<int> order(list.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return list[at(a)].declared < list[at(b)].declared; });
  const std::vector<std::string> classes = {"name", "n", "fit", "name"};
  std::string text = "<div class=\"table\"><table>\n<thead>" +
                     row({verb, "size", "unit", verb == std::string("input") ? "drives" : "reads"},
                         {"", "n", "", ""}, "th") +
                     "</thead>\n<tbody>\n";
  for (std::size_t i = 0; i < order.size() && i < kRows; ++i) {
    const auto& one = list[at(order[i])];
    text += row({diagram::html(one.name), fmt::format("{}", one.size),
                 escaped(units_of(scalars, one.name)), escaped(words(order[i]))},
                classes);
  }
  return text + "</tbody></table></div>\n" +
         more(list.size(), verb == std::string("input") ? "inputs" : "outputs");
}

/// Number of blocks and states per type.
std::string blocks(const Graph& g) {
  std::map<std::string, std::pair<int, int>> types;
  for (const Node& n : g.nodes) {
    auto& [number, states] = types[std::string(n.block->type())];
    ++number;
    if (n.state >= 0) states += g.signals[at(n.state)].size;
  }
  std::string text = "<div class=\"table\"><table>\n<thead>" +
                     row({"type of block", "number", "states together"}, {"", "n", "n"}, "th") +
                     "</thead>\n<tbody>\n";
  for (const auto& [type, numbers] : types)
    text += row(
        {diagram::html(type), fmt::format("{}", numbers.first), fmt::format("{}", numbers.second)},
        {"", "n", "n"});
  return text + "</tbody></table></div>\n";
}

/// A drawing scaled to the page, and links to its full size and back.
std::string diagram(const Subject& s, const Stage& stage, const char* id, const char* title,
                    const std::string& caption) {
  const std::string dot_text = to_dot(stage, {.fold = s.options.fold});
  const std::string svg =
      drawing(dot_text, fmt::format("diagram of {}, {}", stage.now().name, title));
  return fmt::format(
      "<h3 id=\"{1}-scaled\">{0}</h3>\n<figure class=\"diagram\" id=\"{1}\"><div "
      "class=\"canvas\">{2}</div>"
      "<figcaption>{3} <a class=\"full\" href=\"#{1}\">Full size</a><a class=\"scaled\" "
      "href=\"#{1}-scaled\">Scaled to the page</a></figcaption></figure>\n",
      title, id, svg, caption);
}

std::string diagrams(const Subject& s, const Graph& g) {
  if (!s.options.diagrams) return {};
  const Stage& after = s.system.stage();
  Stage before = as_written(g);
  before.values = after.values;
  const std::string added =
      after.motions.empty() ? ""
                            : " Integrators were added for motions that no other state determines.";
  return diagram(s, before, "as-written", "As written",
                 "Filled arrows carry accelerations, open ones forces or wrenches; thick lines are "
                 "vectors, with their size and frame.") +
         diagram(s, after, "after-passes", "After the passes",
                 "Coloured: algebraic loops, numbered; dark heads: inverted channels; grey and "
                 "dashed: set aside, without effect on any output." +
                     added);
}

}  // namespace

std::string scene_section(const Subject& s) {
  const Graph g = written(s.system.stage());
  return blocks(g) + "<h3>Inputs</h3>\n" +
         ports(g.inputs, s.inputs, "input", [&](int i) { return drives(s.system.stage(), i); }) +
         "<h3>Outputs</h3>\n" +
         ports(g.outputs, s.outputs, "output", [&](int i) { return reads(s.system.stage(), i); }) +
         diagrams(s, g);
}

}  // namespace titop::report
