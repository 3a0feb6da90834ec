#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <titop/compiler/keep_memory.hpp>

namespace titop::detail {

/// glibc adapts itself to what it is asked for: when a block that was mapped by itself is freed, it
/// keeps twice as much from then on, blocks of up to 32 MB counted (mallopt(3), on
/// M_MMAP_THRESHOLD). So one such block is taken and freed; as nobody writes to it, it costs no
/// memory.
void keep_memory() {
#if defined(__GLIBC__)
  static std::once_flag once;
  std::call_once(once, [] {
    constexpr std::size_t kJustBelow = (std::size_t{32} << 20) - (std::size_t{64} << 10);
    void* volatile block = std::malloc(kJustBelow);  // volatile: else no block is taken
    std::free(block);
  });
#endif
}

}  // namespace titop::detail
