#pragma once

#include <source_location>

namespace titop {

/// The line at which a part of a diagram was written, for messages: of C++ by default
/// (`SourceLine at = std::source_location::current()`), or of any other text, such as a Python
/// script. Default: none.
class SourceLine {
 public:
  constexpr SourceLine() = default;
  constexpr SourceLine(const std::source_location& at)
      : file_(at.file_name()), line_(static_cast<int>(at.line())) {}
  /// `file` must exist as long as the diagrams, systems and plans made with it; `line` from 1.
  constexpr SourceLine(const char* file, int line) : file_(file), line_(line) {}

  constexpr const char* file_name() const { return file_; }
  constexpr int line() const { return line_; }  ///< 0: none

 private:
  const char* file_ = "";
  int line_ = 0;
};

}  // namespace titop
