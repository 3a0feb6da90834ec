#pragma once

#include <string>

namespace titop::report {

/// A Graphviz text as an `<svg>` element for a page, drawn by `dot`: without ids (a page has
/// several), comments and tool tips. `subject`: its description for readers that do not see it.
/// Throws bad_file if `dot` is missing or fails.
std::string drawing(const std::string& dot_text, const std::string& subject);

}  // namespace titop::report
