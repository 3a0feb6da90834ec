#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <titop/compiler/solve/memory.hpp>
#if defined(__GLIBC__)
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace titop::detail {

/// glibc adapts its mmap threshold: when a block that was mapped by itself is freed, it keeps twice
/// as much from then on, for blocks of up to 32 MB (mallopt(3), on M_MMAP_THRESHOLD). So one such
/// block is allocated and freed; as it is never written to, it uses no memory.
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

void take_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr std::size_t kLarge = std::size_t{4} << 20;  // two such pages: one at least is whole
  if (bytes < kLarge) return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(begin) + bytes;
  // Advice: where it is not taken, pages are small.
  madvise(reinterpret_cast<void*>(first), (end - first) / page * page, MADV_HUGEPAGE);
#endif
}

}  // namespace titop::detail
