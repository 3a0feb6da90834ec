#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/compiler/diagram/text.hpp>

namespace titop::diagram {

/// The diagram's name, and the meaning of the signs that occur.
std::string draw_legend(const Picture& p) {
  const Graph& g = p.graph;
  std::vector<std::string> words;
  if (!g.channels.empty()) words.insert(words.end(), {"▶ acceleration", "▷ force or wrench"});
  const bool vectors = std::any_of(g.signals.begin(), g.signals.end(), [](const Signal& s) {
    return s.role != Signal::Role::state && s.size > 1;
  });
  if (vectors) words.push_back("thick: vector (size, frame)");
  if (std::count(p.inverted.begin(), p.inverted.end(), 1) > 0)
    words.push_back("⁻¹ dark: inverted channel");
  const int loops = p.loop.empty() ? 0 : *std::max_element(p.loop.begin(), p.loop.end());
  if (loops > 0) words.push_back("↻ coloured: algebraic loop");
  const bool removed =
      std::any_of(g.signals.begin(), g.signals.end(), [](const Signal& s) { return !s.active; });
  if (removed) words.push_back("grey, dashed: set aside");
  if (!p.fold.boxes.empty()) words.push_back("▤ folded: many blocks, ×n: so many wires");
  const std::string name = fmt::format("<BR/><B>{}</B>", html(g.name));
  if (words.empty()) return name;  // Graphviz refuses empty elements
  return name + "<BR/>" +
         font(fmt::format("{}", fmt::join(words, " &#160; &#160; ")), 9, colour::soft);
}

}  // namespace titop::diagram
