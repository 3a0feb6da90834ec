#pragma once

#include <string_view>

/// Helpers that the tests share.
namespace titop_test {

/// Prints why the calling test cannot run here (a program is not installed). If nothing else fails,
/// the whole test program then counts as skipped in ctest's summary, not as passed.
void skip(std::string_view reason);

}  // namespace titop_test
