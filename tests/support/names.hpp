#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <complex>
#include <initializer_list>
#include <string>
#include <string_view>

/// Names and numbers in the texts of errors, logs and reports. Tests assert these, beside the code
/// of an error and the pass of a log line, and no sentences: prose may be rewritten.
namespace titop_test {

/// True if text has this name or number as a whole: z1 is not in "z12" nor in "z1_rate"; 2 is not
/// in "0.2", "2.5", "-2" nor "2x2". A piece of code counts as a name: "d.output(\"y\")".
inline bool has_name(std::string_view text, std::string_view name) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto of_a_name = [](char c) {
    return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0;
  };
  const auto longer_before = [&](std::string_view before) {
    if (before.empty() || !of_a_name(name.front())) return false;
    const char c = before.back();
    const bool point = c == '.' && before.size() > 1 && digit(before[before.size() - 2]);
    return of_a_name(c) || (digit(name.front()) && (c == '-' || point));
  };
  const auto longer_after = [&](std::string_view after) {
    if (after.empty() || !of_a_name(name.back())) return false;
    const bool point = after.front() == '.' && after.size() > 1 && digit(after[1]);
    return of_a_name(after.front()) || (digit(name.back()) && point);
  };
  for (auto at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1))
    if (!longer_before(text.substr(0, at)) && !longer_after(text.substr(at + name.size())))
      return true;
  return false;
}

inline bool has_names(std::string_view text, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (!has_name(text, name)) return false;
  return true;
}

/// True if one line of the text has all of them.
inline bool has_line(std::string_view text, std::initializer_list<std::string_view> names) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (has_names(line, names)) return true;
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return false;
}

/// "s = 0.3-2j", as texts show a point s.
inline std::string at_s(std::complex<double> s) {
  return fmt::format("s = {:.3g}{:+.3g}j", s.real(), s.imag());
}

/// "1.2e-09", as texts show an error.
inline std::string two_digits(double error) { return fmt::format("{:.1e}", error); }

}  // namespace titop_test
