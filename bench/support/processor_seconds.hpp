#pragma once

#include <ctime>

namespace titop_bench {

/// CPU time [s] of this process so far, on all cores: independent of other load on the machine,
/// except for shared caches.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace titop_bench
