#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

#include "support/skip.hpp"

namespace {

constexpr int kSkipped = 77;  // SKIP_RETURN_CODE in tests/CMakeLists.txt
bool skipped = false;

}  // namespace

void titop::test::skip(std::string_view reason) {
  std::printf("SKIPPED: %.*s\n", static_cast<int>(reason.size()), reason.data());
  skipped = true;
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  const int code = context.run();
  return code == 0 && skipped ? kSkipped : code;
}
