#pragma once

#include <fmt/format.h>

#include <string>
#include <titop/compiler/diagram/text.hpp>
#include <vector>

/// Pieces of the page.
namespace titop::report {

/// Text of any origin, escaped for HTML; empty for empty text.
inline std::string escaped(const std::string& text) {
  return text.empty() ? "" : diagram::html(text);
}

/// Text of several lines.
std::string escaped_lines(const std::string& text);

/// The page around its body: head, style, no external resources. `title` is plain text.
std::string page(const std::string& title, const std::string& body);

/// A table's row of cells that are HTML; classes by column, "" for none.
inline std::string row(const std::vector<std::string>& cells,
                       const std::vector<std::string>& classes, const char* tag = "td") {
  std::string text = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string& cls = classes[i];
    text += fmt::format("<{0}{1}>{2}</{0}>", tag, cls.empty() ? "" : " class=\"" + cls + "\"",
                        cells[i]);
  }
  return text + "</tr>\n";
}

/// A number for a table or a sentence: 4 digits, "1.2·10⁻⁵" if it is small or large. Plain text,
/// that is HTML as well.
std::string number(double x, int digits = 4);

/// "10⁻³"
std::string power_of_ten(int exponent);

/// "1 state", "2 states".
inline std::string count(std::size_t n, const char* subject) {
  return fmt::format("{} {}{}", n, subject, n == 1 ? "" : "s");
}

}  // namespace titop::report
