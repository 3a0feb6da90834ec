#pragma once

#include <string>
#include <vector>

namespace titop::report {

/// Result of a program.
struct Finished {
  bool found = false;  ///< there is such a program
  int code = 0;        ///< its exit code; 128 + n if signal n ended it
  std::string out, err;
};

/// Runs a program of the PATH with these words and this standard input, and waits for it. Without
/// shell and named files: no part of the words or the text is interpreted.
Finished run(const std::vector<std::string>& words, const std::string& in);

}  // namespace titop::report
