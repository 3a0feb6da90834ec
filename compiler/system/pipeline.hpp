#pragma once

#include <span>

namespace titop {

/// A pass of the compiler.
struct CompilerPass {
  const char* name;
  const char* promise;    ///< property of the result
  const char* when = "";  ///< it runs only then; "": always
};

/// All passes in their order, the table of pipeline.cpp: System::seconds and System::dense_seconds
/// list those that have run.
std::span<const CompilerPass> compiler_passes();

}  // namespace titop
