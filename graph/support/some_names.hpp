#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

namespace titop::detail {

/// "a, b, c", of more than eight "a, ..., h, and 12 more": for notes.
inline std::string some_names(std::span<const std::string> names) {
  constexpr std::size_t most = 8;
  const auto shown = names.first(std::min(names.size(), most));
  return fmt::format("{}{}", fmt::join(shown, ", "),
                     names.size() > most ? fmt::format(", and {} more", names.size() - most) : "");
}

}  // namespace titop::detail
