#pragma once

#include <string>
#include <string_view>

/// Text of any origin in Graphviz files.
namespace titop::diagram {

/// Bytes of the UTF-8 character that `text`, not empty, begins with; 0 if it begins with none.
std::size_t utf8_length(std::string_view text);
/// `text` for a label: broken UTF-8 and control characters become U+FFFD.
std::string clean(std::string_view text);
/// A quoted Graphviz string that shows `text`, which may have any characters.
std::string quoted(std::string_view text);
/// `text` inside an HTML-like label. Never empty: Graphviz refuses empty elements.
std::string html(std::string_view text);
/// Text in another size and colour inside an HTML-like label; `text` is taken as HTML.
std::string font(std::string_view text, int size, std::string_view colour);

/// Colours. In black and white they differ by width, dash, or an added sign.
namespace colour {
constexpr std::string_view ink = "#1F2933";
constexpr std::string_view line = "#3E4C59";
constexpr std::string_view soft = "#616E7C";
constexpr std::string_view removed = "#9AA5B1";
constexpr std::string_view body = "#D9E2EC";
constexpr std::string_view controller = "#F5EBDA";
constexpr std::string_view paper = "#FFFFFF";
/// Line and fill of loop number 1, 2, ...; they repeat after the sixth.
std::string_view loop_line(int number);
std::string_view loop_fill(int number);
}  // namespace colour

}  // namespace titop::diagram
