#pragma once

#include <ctime>

namespace titop_bench {

/// Of this process so far, on all cores: what one thread does takes the same whatever else runs,
/// but for caches.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace titop_bench
