#include <doctest/doctest.h>
#include <pthread.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <new>
#include <titop/graph/support/workers.hpp>

/// A thread whose memory cannot be allocated. (A separate program: clang's thread sanitizer, under
/// which the tests of threads and of kernels run, replaces operator new.)

namespace {
thread_local bool no_memory = false;
}

// (Inlined, g++ takes malloc and delete for a pair that does not match.)
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* const result = no_memory ? nullptr : std::malloc(size);
  if (!result) throw std::bad_alloc();
  return result;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return no_memory ? nullptr : std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

TEST_CASE("threads: where there is no memory for one, the caller does all by itself") {
  using titop::detail::work_together;
  int done = 0, asked = 0;
  const std::function<void()> work = [&] { ++done; };
  const std::function<bool()> over = [] { return false; }, more = [&] { return ++asked > 0; };
  work_together(1, work, over);  // creates the data that all calls share
  no_memory = true;
  work_together(2, work, more);
  no_memory = false;
  CHECK(done == 2);
  CHECK(asked == 1);
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  CHECK(sigismember(&blocked, SIGINT) == 0);
}
