#pragma once

#include <initializer_list>
#include <source_location>
#include <string>
#include <string_view>
#include <titop/compiler/system/system.hpp>

/// The user's view: the error that is thrown, and whether it has the expected text.
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

/// True if one mistake of this code contains all of these texts, in its message, details or hint.
inline bool says(const titop::Error& error, titop::Code code,
                 std::initializer_list<std::string_view> parts) {
  for (const titop::Mistake& m : error.mistakes()) {
    const std::string text = titop::Error(m).what();
    bool all = m.code == code && !m.hint.empty();
    for (const std::string_view part : parts) all = all && text.find(part) != std::string::npos;
    if (all) return true;
  }
  return false;
}

/// "graph/ports.cpp:17", the line after that of this call.
inline std::string next_line(std::source_location at = std::source_location::current()) {
  const std::string here = titop::to_string(at);
  return here.substr(0, here.rfind(':') + 1) + std::to_string(at.line() + 1);
}

}  // namespace titop_test
