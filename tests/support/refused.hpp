#pragma once

#include <doctest/doctest.h>

#include <string>
#include <titop/graph/error.hpp>

#include "support/mistakes.hpp"

/// Broken input, and its error.
namespace titop_test {

/// The text with this part of it, which must be there, replaced once.
inline std::string replaced(std::string text, const std::string& subject, const std::string& with) {
  const auto at = text.find(subject);
  REQUIRE(at != std::string::npos);
  return text.replace(at, subject.size(), with);
}

/// The text of the error that f() throws; "no error" if it throws none.
template <class F>
std::string message_of(F f) {
  try {
    f();
  } catch (const titop::Error& error) {
    return error.what();
  }
  return "no error";
}

/// f() is refused for a mistake of this code with these names and numbers.
template <class F>
void check_refused(F f, titop::Code code, std::initializer_list<std::string_view> names) {
  const titop::Error error = error_of(f);
  INFO(error.what());
  CHECK(has_mistake(error, code, names));
}

}  // namespace titop_test
