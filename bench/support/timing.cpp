#include "timing.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <string_view>

namespace titop_bench {
namespace {

/// State common to the points of one method during a run.
struct Line {
  Method method;
  double limit = 10;  ///< seconds per point
  int n = 0;          ///< size of `prepared`
  Prepared prepared = {};
  double difference = 0, seconds = 0;
  double growth = 1.5;  ///< exponent from the last size to this one
};

bool too_long(const Line& line, int n) {
  const double growth = std::min(3.0, std::max(1.0, line.growth + 0.5));
  return line.n > 0 && n > line.n &&
         line.seconds * std::pow(n / double(line.n), growth) > line.limit;
}

void note_time(Line& line, double seconds, int last_n, double last) {
  if (last > 0 && line.n > last_n)
    line.growth = std::log(seconds / last) / std::log(line.n / double(last_n));
  line.seconds = seconds;
}

/// Once per point, not once per repetition: it may take longer than the timed part.
void prepare(Line& line, int n) {
  if (line.n == n) return;
  line.prepared = {};
  line.prepared = line.method.prepare(n);
  line.n = n;
  line.prepared.once();
  line.difference = line.prepared.difference ? line.prepared.difference() : 0;
}

void measure(benchmark::State& state, const std::shared_ptr<Line>& line, int n) {
  if (too_long(*line, n)) {
    state.SkipWithError("given up");
    return;
  }
  const int last_n = line->n;
  prepare(*line, n);
  double fastest = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    line->prepared.once();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, elapsed.count());
  }
  note_time(*line, fastest, last_n, line->seconds);
  state.counters["fastest"] = fastest;
  state.counters["difference"] = line->difference;
}

/// The fastest run of each point as one row: Octave's are taken so, too (methods/octave.m).
class Rows : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override {
    fmt::print("task,scene,n,method,seconds,difference,note\n");
    return true;
  }
  void ReportRuns(const std::vector<Run>& runs) override {
    const Run* best = nullptr;
    for (const Run& r : runs)
      if (r.run_type == Run::RT_Iteration && (!best || seconds(r) < seconds(*best))) best = &r;
    if (!best) return;
    const std::string name = best->run_name.function_name;
    std::string row = name;
    for (char& c : row)
      if (c == '/') c = ',';
    if (best->error_occurred) {
      fmt::print("{},,,{}\n", row, best->error_message);
    } else {
      const double difference = best->counters.at("difference");
      const bool agrees = difference <= kAgreement;
      all_agree = all_agree && agrees;
      fmt::print("{},{:.4g},{:.2g},{}\n", row, seconds(*best), difference,
                 agrees ? "" : "disagrees");
      fmt::print(stderr, "{:<50} {:>11.4g} ms\n", name, 1e3 * seconds(*best));
    }
    std::fflush(stdout);
  }
  bool all_agree = true;

 private:
  static double seconds(const Run& r) {
    return r.error_occurred ? std::numeric_limits<double>::infinity()
                            : r.counters.at("fastest").value;
  }
};

void add(const Method& method, bool quick) {
  const auto line = std::make_shared<Line>();
  line->method = method;
  if (quick) line->limit = 1;
  for (const int n : method.sizes) {
    if (quick && n > kQuickSize) continue;
    const std::string name = fmt::format("{}/{}/{}/{}", method.task, method.scene, n, method.name);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [line, n](benchmark::State& state) { measure(state, line, n); })
        ->MinTime(quick ? 0.005 : 0.1)
        ->Repetitions(quick ? 1 : 2)
        ->UseRealTime();
  }
}

}  // namespace

int run(int argc, char** argv, const std::vector<Method>& methods) {
  const bool quick = argc > 1 && std::string_view(argv[1]) == "quick";
  if (quick) {
    argv[1] = argv[0];
    --argc, ++argv;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const Method& m : methods) add(m, quick);
  Rows rows;
  benchmark::RunSpecifiedBenchmarks(&rows);
  return rows.all_agree ? 0 : 1;
}

}  // namespace titop_bench
