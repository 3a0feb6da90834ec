#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>

#include "support/cases.hpp"

/// One point of the growth charts per process, for separate memory: `growth SCENE N [REPETITIONS]`
/// prints one row. No dense model is made. The first compile has fresh memory at every size; later
/// compiles reuse memory that the C library has kept, up to a size. A scene of ten bodies is
/// compiled first, for the one-time cost of a process.
namespace titop_bench {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Resident memory [bytes].
double resident() {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0;
  while (status >> word)
    if (word == "VmRSS:") status >> kilobytes;
  return 1024 * kilobytes;
}

double peak() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<double>(usage.ru_maxrss);
}

/// Seconds of the fastest of some runs of `f`; its last result in `result`.
template <class F>
double best(int repetitions, F f) {
  double seconds = HUGE_VAL;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = Clock::now();
    f();
    seconds = std::min(seconds, since(start));
  }
  return seconds;
}

void point(Case c, int n, int repetitions) {
  compile(case_diagram(c, 10), {.minimize_up_to = 0});
  const double before = resident();
  const auto start = Clock::now();
  const titop::Diagram diagram = case_diagram(c, n, {.varies = Varies::one});
  const double built = since(start), with_diagram = resident();
  const auto compile_start = Clock::now();
  const titop::System system = compile(diagram, {.minimize_up_to = 0});
  const double compiled = since(compile_start);
  const double with_system = resident(), highest = peak();
  const double again = best(repetitions, [&] { compile(diagram, {.minimize_up_to = 0}); });
  const double transfer = best(repetitions, [&] { system.transfer({1, 3}); });
  const double changed = best(repetitions, [&] { system.update({{"p", 1.0625}}); });
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(system.order());
  const Eigen::VectorXd u =
      Eigen::VectorXd::Ones(static_cast<Eigen::Index>(system.inputs().size()));
  const double product = best(repetitions, [&] { system.apply(x, u); });
  fmt::print("{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.0f},{:.0f},{:.0f},{:.4g}\n",
             name_of(c), n, system.order(), built, compiled, transfer, changed, product,
             with_diagram - before, with_system - with_diagram, highest - before, again);
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(
        "scene,n,states,diagram,compile,transfer,change one,apply,diagram bytes,system bytes,"
        "peak bytes,compile again\n");
    return 0;
  }
  try {
    if (argc < 3) throw std::invalid_argument("growth SCENE N [REPETITIONS]");
    titop_bench::point(titop_bench::case_of(argv[1]), std::atoi(argv[2]),
                       argc > 3 ? std::atoi(argv[3]) : 3);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
