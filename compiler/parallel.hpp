#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace titop::detail {

/// How many threads to take for `tasks` independent tasks: `wanted`, or all cores where it is 0.
inline int thread_count(int wanted, std::size_t tasks) {
  // Asked for once: it reads a file, which takes longer than writing a small model.
  static const auto cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto most = static_cast<int>(std::min<std::size_t>(tasks, 4096));
  return std::max(1, std::min(wanted > 0 ? wanted : cores, most));
}

/// Runs task(i) for i = 0 ... count - 1, in no order, on `threads` threads; make() gives each
/// thread its own task object (its workspace). What a task does must not depend on the others: the
/// results are then the same for any number of threads. Of several exceptions the one of the lowest
/// i is thrown, once all threads have stopped.
template <class Make>
void parallel(std::size_t count, int threads, Make make) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> failed(count);
  std::atomic<bool> stop{false};
  const auto run = [&] {
    auto task = make();
    for (std::size_t i = next++; i < count && !stop; i = next++) {
      try {
        task(i);
      } catch (...) {
        failed[i] = std::current_exception();
        stop = true;
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int t = 1; t < thread_count(threads, count); ++t) pool.emplace_back(run);
    run();
  }
  for (const std::exception_ptr& e : failed)
    if (e) std::rethrow_exception(e);
}

}  // namespace titop::detail
