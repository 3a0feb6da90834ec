#pragma once

#include <doctest/doctest.h>

#include <string>
#include <titop/graph/error.hpp>

/// Broken input, and the text of its error.
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

/// f() is refused, in these words among others.
template <class F>
void check_refused(F f, const std::string& words) {
  const std::string said = message_of(f);
  INFO(said);
  CHECK(said != "no error");
  CHECK(said.find(words) != std::string::npos);
}

}  // namespace titop_test
