#include <fmt/format.h>

#include <titop/compiler/diagram/text.hpp>
#include <titop/emit/report/drawing.hpp>
#include <titop/emit/report/program.hpp>
#include <titop/graph/error.hpp>

namespace titop::report {
namespace {

/// `text` without the parts from `open` to `close`. Graphviz escapes < and " in all text of ours.
std::string without(const std::string& text, std::string_view open, std::string_view close) {
  std::string rest;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(open, from)) != std::string::npos;) {
    rest.append(text, from, at - from);
    const std::size_t end = text.find(close, at + open.size());
    from = end == std::string::npos ? text.size() : end + close.size();
  }
  return rest.append(text, from);
}

std::string attribute(const std::string& tag, const std::string& name) {
  const std::size_t at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) return {};
  const std::size_t from = at + name.size() + 3;
  return tag.substr(from, tag.find('"', from) - from);
}

[[noreturn]] void refuse(const std::string& why, const std::string& hint,
                         std::vector<std::string> details = {}) {
  throw Error(Code::bad_file, "the diagram cannot be drawn: " + why,
              hint +
                  "leave the diagrams out (ReportOptions::diagrams = false, titop report "
                  "--no-diagrams)",
              std::move(details));
}

}  // namespace

std::string drawing(const std::string& dot_text, const std::string& subject) {
  const Finished dot = run({"dot", "-Tsvg", "-Gbgcolor=transparent"}, dot_text);
  if (!dot.found)
    refuse("the program dot is not installed", "install Graphviz (Debian package graphviz), or ");
  const std::size_t start = dot.out.find("<svg"), end = dot.out.find('>', start);
  if (dot.code != 0 || end == std::string::npos || dot.out.rfind("</svg>") == std::string::npos)
    refuse(fmt::format("dot ends with {}", dot.code),
           "this Graphviz may be broken, or too old (its version: dot -V): take another, or ",
           {dot.err.substr(0, dot.err.find('\n'))});
  const std::string tag = dot.out.substr(start, end - start);
  std::string body = dot.out.substr(end + 1, dot.out.rfind("</svg>") - end - 1);
  body = without(body, "<!--", "-->");
  body = without(body, "<title>", "</title>");
  body = without(body, " id=\"", "\"");
  return fmt::format(
      R"(<svg class="drawing" role="img" aria-label="{}" width="{}" height="{}" viewBox="{}">{}</svg>)",
      diagram::html(subject), attribute(tag, "width"), attribute(tag, "height"),
      attribute(tag, "viewBox"), body);
}

}  // namespace titop::report
