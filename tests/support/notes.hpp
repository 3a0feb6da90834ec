#pragma once

#include <initializer_list>
#include <string_view>
#include <titop/compiler/system/system.hpp>
#include <vector>

#include "support/names.hpp"

/// Lines of the log by kind, pass, names and numbers.
namespace titop_test {

/// Notes of this kind and pass with all of these names and numbers.
inline int count_notes(const std::vector<titop::Note>& notes, titop::Note::Kind kind,
                       std::string_view pass, std::initializer_list<std::string_view> names) {
  int count = 0;
  for (const titop::Note& n : notes)
    count += n.kind == kind && n.pass == pass && has_names(n.text, names);
  return count;
}

/// The same among the notes of the system, and of its dense model if it is one of its passes.
inline int count_notes(const titop::System& system, titop::Note::Kind kind, std::string_view pass,
                       std::initializer_list<std::string_view> names = {}) {
  const bool of_dense = pass == "dense" || pass == "minimize";
  return count_notes(of_dense ? system.dense_notes() : system.notes(), kind, pass, names);
}

/// True if there is such a line.
inline bool noted(const titop::System& system, titop::Note::Kind kind, std::string_view pass,
                  std::initializer_list<std::string_view> names = {}) {
  return count_notes(system, kind, pass, names) > 0;
}

/// True if the log warns that outputs lose digits in double, at the s of the certificate.
inline bool outputs_lose_digits(const titop::System& system) {
  return noted(system, titop::Note::Kind::warning, "certify",
               {fmt::format("s = {:.3g}", system.certificate().s)});
}

/// True if the log says that the dense model was not tried at some |s|, or at any.
inline bool dense_not_tried(const titop::System& system) {
  return noted(system, titop::Note::Kind::warning, "dense", {"|s|"}) ||
         noted(system, titop::Note::Kind::unchecked, "dense", {"|s|"});
}

}  // namespace titop_test
