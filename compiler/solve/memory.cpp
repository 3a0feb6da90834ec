#include <cstdint>
#include <titop/compiler/solve/memory.hpp>
#if defined(__GLIBC__)
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace titop::detail {

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
