#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <optional>
#include <thread>
#include <vector>

namespace titop::detail {

/// Number of threads for `tasks` independent tasks: `wanted`, or all cores if it is 0.
inline int thread_count(int wanted, std::size_t tasks) {
  // Called once: it reads a file, which takes longer than writing a small model.
  static const auto cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto most = static_cast<int>(std::min<std::size_t>(tasks, 4096));
  return std::max(1, std::min(wanted > 0 ? wanted : cores, most));
}

/// Runs task(i) for i = 0 ... count - 1, in no order, on this thread and up to `threads` - 1 more,
/// which end with the call; make() gives each thread its own task object (its workspace). Tasks
/// must not depend on each other: the results are then the same for any number of threads. If tasks
/// throw, all threads stop, all tasks before the lowest failed i are completed, and its exception
/// is rethrown. If a thread cannot be started, there are fewer.
template <class Make>
void parallel(std::size_t count, int threads, Make make) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> failed(count);
  std::atomic<std::size_t> end{count};  // the first that has failed: those before it are still done
  const auto work = [&] {
    std::optional<decltype(make())> task;
    for (std::size_t i = next++; i < end; i = next++) {
      try {
        if (!task) task.emplace(make());
        (*task)(i);
      } catch (...) {
        failed[i] = std::current_exception();
        for (std::size_t e = end; i < e && !end.compare_exchange_weak(e, i);) {
        }
      }
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (int k = thread_count(threads, count) - 1; k > 0 && next + 1 < end; --k)
        others.emplace_back(work);
    } catch (const std::exception&) {  // no thread, or no memory for one
    }
    work();
  }
  for (const std::exception_ptr& e : failed)
    if (e) std::rethrow_exception(e);
}

}  // namespace titop::detail
