#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>

/// Growth of processor time with the size of a task.
namespace titop_test {

inline constexpr int kTimes = 8;
/// Of time, for kTimes as much: n log n gives 11 at usual sizes, n^2 64.
inline constexpr double kNearlyLinear = 20;

/// On all cores [s].
template <class F>
double processor_seconds(F f) {
  const std::clock_t start = std::clock();
  f();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Time for kTimes * n over that for n; `prepare(n)` returns what is timed. The least of up to
/// three runs counts: other work on the machine costs time in caches.
template <class Prepare>
double growth(int n, Prepare prepare) {
  auto few = prepare(n), many = prepare(kTimes * n);
  double of_few = HUGE_VAL, of_many = HUGE_VAL;
  for (int run = 0; run == 0 || (run < 3 && of_many > kNearlyLinear * of_few); ++run) {
    of_few = std::min(of_few, processor_seconds(few));
    of_many = std::min(of_many, processor_seconds(many));
  }
  return of_many / of_few;
}

}  // namespace titop_test
