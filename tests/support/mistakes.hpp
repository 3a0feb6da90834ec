#pragma once

#include <algorithm>
#include <initializer_list>
#include <source_location>
#include <string>
#include <string_view>
#include <titop/compiler/system/system.hpp>

#include "support/names.hpp"

/// The user's view: the error that is thrown, its code, and the names and numbers in its text.
namespace titop_test {

/// The error that f() throws; one without mistakes if it throws none.
template <class F>
titop::Error error_of(F f) {
  try {
    f();
  } catch (const titop::Error& error) {
    return error;
  }
  return titop::Error(std::vector<titop::Mistake>{});
}

inline titop::Error compile_error(const titop::Diagram& d) {
  return error_of([&] { titop::compile(d); });
}

/// Message, details and hint, without the code.
inline std::string text_of_mistake(const titop::Mistake& m) {
  std::string text = m.message;
  for (const std::string& line : m.details) text += "\n" + line;
  return text + "\n" + m.hint;
}

/// True if one mistake of this code has all of these names and numbers, in its message, details or
/// hint.
inline bool has_mistake(const titop::Error& error, titop::Code code,
                        std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(error.mistakes(), [&](const titop::Mistake& m) {
    return m.code == code && has_names(text_of_mistake(m), names);
  });
}

/// The same, and it has a hint.
inline bool says(const titop::Error& error, titop::Code code,
                 std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(error.mistakes(), [&](const titop::Mistake& m) {
    return m.code == code && !m.hint.empty() && has_names(text_of_mistake(m), names);
  });
}

/// True if the transfer from this input to this output is refused, as it needs so many derivatives.
inline bool needs_derivatives(const titop::Error& error, std::string_view input,
                              std::string_view output, int count) {
  return std::ranges::any_of(error.mistakes(), [&](const titop::Mistake& m) {
    return m.code == titop::Code::improper && !m.hint.empty() &&
           has_names(m.message, {input, output, std::to_string(count)});
  });
}

/// "graph/ports.cpp:17", the line after that of this call.
inline std::string next_line(std::source_location at = std::source_location::current()) {
  const std::string here = titop::to_string(at);
  return here.substr(0, here.rfind(':') + 1) + std::to_string(at.line() + 1);
}

}  // namespace titop_test
