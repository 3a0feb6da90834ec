#include <fmt/format.h>

#include <array>
#include <titop/compiler/diagram/text.hpp>

namespace titop::diagram {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Control characters (the C1 ones, too) and U+FFFE, U+FFFF, which no SVG may hold.
bool is_unprintable(std::string_view c) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(c[i]); };
  if (c.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7F;
  return (byte(0) == 0xC2 && byte(1) < 0xA0) ||
         (byte(0) == 0xEF && byte(1) == 0xBF && byte(2) >= 0xBE);
}

template <class Put>
void each_character(std::string_view text, Put put) {
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    put(n == 0 || is_unprintable(text.substr(0, n)) ? kReplacement : text.substr(0, n));
    text.remove_prefix(n == 0 ? 1 : n);
  }
}

/// Entities are read in quoted labels too: a user's "&lt;" must not turn into "<".
std::string escaped(std::string_view text, bool in_html) {
  std::string out;
  each_character(text, [&](std::string_view c) {
    if (c == "&")
      out += "&amp;";
    else if (in_html && c == "<")
      out += "&lt;";
    else if (in_html && c == ">")
      out += "&gt;";
    else if (in_html && c == "\"")
      out += "&quot;";
    else if (!in_html && (c == "\"" || c == "\\"))
      (out += '\\') += c;
    else
      out += c;
  });
  return out;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char b = byte(0);
  const std::size_t n = b < 0x80                ? 1
                        : b >= 0xC2 && b < 0xE0 ? 2
                        : b >= 0xE0 && b < 0xF0 ? 3
                        : b >= 0xF0 && b < 0xF5 ? 4
                                                : 0;
  if (n == 0 || n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  if (n == 1) return 1;
  const unsigned char c = byte(1);  // overlong forms, surrogates, beyond U+10FFFF
  if ((b == 0xE0 && c < 0xA0) || (b == 0xED && c > 0x9F)) return 0;
  if ((b == 0xF0 && c < 0x90) || (b == 0xF4 && c > 0x8F)) return 0;
  return n;
}

std::string clean(std::string_view text) {
  std::string out;
  each_character(text, [&](std::string_view c) { out += c; });
  return out;
}

std::string quoted(std::string_view text) { return '"' + escaped(text, false) + '"'; }

std::string html(std::string_view text) {
  return text.empty() ? std::string("(no name)") : escaped(text, true);
}

std::string font(std::string_view text, int size, std::string_view colour) {
  return fmt::format(R"(<FONT POINT-SIZE="{}" COLOR="{}">{}</FONT>)", size, colour, text);
}

namespace colour {
namespace {
/// Okabe and Ito's palette, which colour-blind readers can distinguish; fills are tints of it.
constexpr std::array<std::string_view, 6> kLines = {"#D55E00", "#0072B2", "#009E73",
                                                    "#AA4499", "#B8860B", "#56609C"};
constexpr std::array<std::string_view, 6> kFills = {"#FBE3D3", "#D6E9F5", "#D5EFE7",
                                                    "#F2DDEE", "#F6EBCB", "#DFE1F0"};
std::size_t index(int number) { return static_cast<std::size_t>(number - 1) % kLines.size(); }
}  // namespace

std::string_view loop_line(int number) { return kLines[index(number)]; }
std::string_view loop_fill(int number) { return kFills[index(number)]; }
}  // namespace colour

}  // namespace titop::diagram
