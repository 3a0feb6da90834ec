#pragma once

#include <functional>
#include <string>
#include <vector>

/// Common to the Google Benchmark programs here: names, time limit of a point, and one CSV row per
/// point.
namespace titop_bench {

/// A method at one size, ready to be timed.
struct Prepared {
  std::function<void()> once;          ///< the timed part
  std::function<double()> difference;  ///< of its result from titop's; empty: no comparison
};

/// One line of a chart: points "task/scene/n/name".
struct Method {
  std::string task, scene, name;
  std::vector<int> sizes;
  std::function<Prepared(int n)> prepare;
};

/// Sizes above this are omitted from a quick run; everything runs once then.
constexpr int kQuickSize = 30;

/// Results further apart than this are marked in the table, and the program returns 1.
constexpr double kAgreement = 1e-6;

/// Times all points. A point is omitted if, by the growth of the last two, it would take longer
/// than 10 s (quick: 1 s). CSV to stdout (task, scene, n, method, seconds, difference, note),
/// progress to stderr; the time is the best of three repetitions. `argv[1]` may be "quick"; the
/// rest goes to Google Benchmark. Returns the exit code of main().
int run(int argc, char** argv, const std::vector<Method>& methods);

}  // namespace titop_bench
