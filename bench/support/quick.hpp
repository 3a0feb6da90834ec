#pragma once

#include <string_view>

namespace titop_bench {

/// Called as `bench_NAME quick`: few points, small sizes.
inline bool is_quick(int argc, char** argv) {
  return argc > 1 && std::string_view(argv[1]) == "quick";
}

}  // namespace titop_bench
