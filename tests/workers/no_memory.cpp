#include <doctest/doctest.h>

#include <cstdlib>
#include <new>
#include <titop/graph/support/parallel.hpp>

/// A thread whose memory cannot be allocated. (A separate program: clang's thread sanitizer, under
/// which the tests of threads and of kernels run, replaces operator new.)

namespace {

thread_local int left = -1;  ///< allocations that are granted; below 0: all

void* allocate(std::size_t size) {
  if (left == 0) return nullptr;
  if (left > 0) --left;
  return std::malloc(size);
}

}  // namespace

// (Inlined, g++ takes malloc and delete for a pair that does not match.)
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* const result = allocate(size);
  if (!result) throw std::bad_alloc();
  return result;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

TEST_CASE("threads: if there is no memory for one, the caller does all by itself") {
  // The first allocation is that of the errors, the second the list of threads, the third a thread.
  for (int granted = 1; granted <= 3; ++granted) {
    std::atomic<int> done = 0;
    left = granted;
    titop::detail::parallel(40, 3, [&] { return [&](std::size_t) { ++done; }; });
    left = -1;
    CHECK(done == 40);
  }
}
