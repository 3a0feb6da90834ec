#pragma once

#include <string>

/// Names and warnings in files of which a line, or the file, ends at some control characters.
namespace titop::emit {

/// The text with a blank in place of every control character of ASCII.
std::string on_one_line(std::string text);

}  // namespace titop::emit
