#pragma once

#include <string>

namespace titop::report {

/// A Graphviz text as an `<svg>` element to stand in a page, drawn by `dot`: without ids (several
/// stand in one page), comments and tool tips. `what` names it for readers that do not see it.
/// Throws bad_file where `dot` is missing or fails.
std::string drawing(const std::string& dot_text, const std::string& what);

}  // namespace titop::report
