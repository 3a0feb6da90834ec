#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "support/cases.hpp"

/// Cost of the certificate that every first compile makes: its share of a compile with a dense
/// model into a warm buffer, and its ratio to an update of all bodies. All alternately, many times,
/// the dense model on one core; the best of each.
namespace titop_bench {
namespace {

using titop::Diagram;
using titop::StateSpace;
using titop::System;

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Writes one row. False if the certificate finds a fault.
bool row(Case c, int n, int rounds) {
  const Diagram diagram = case_diagram(c, n), varied = case_diagram(c, n, {.varies = Varies::all});
  const titop::Options options{.minimize_up_to = 0};
  const System first = compile(varied, options);
  StateSpace dense;
  compile(diagram, options).write(dense, 1);
  double model = HUGE_VAL, certificate = HUGE_VAL, new_values = HUGE_VAL;
  bool holds = true;
  for (int i = 0; i < rounds; ++i) {
    auto start = Clock::now();
    const System system = compile(diagram, options);
    system.write(dense, 1);
    model = std::min(model, since(start));
    const titop::Certificate found = system.certificate();
    certificate = std::min(certificate, found.seconds);
    holds = holds && found.residual < 1e-10;
    start = Clock::now();
    const System other = first.update({{"p", i % 2 ? 1.0625 : 1.03125}});
    new_values = std::min(new_values, since(start));
  }
  fmt::print("{},{},{:.4g},{:.4g},{:.4g},{:.3f},{:.2f}\n", name_of(c), n, model, certificate,
             new_values, certificate / model, certificate / new_values);
  return holds;
}

}  // namespace
}  // namespace titop_bench

/// `certificate [quick]`: CSV to stdout, 1 if a scene's equations do not hold.
int main(int argc, char** argv) {
  using titop_bench::Case;
  const bool quick = argc > 1 && !std::strcmp(argv[1], "quick");
  const std::vector<int> sizes = quick ? std::vector<int>{10} : std::vector<int>{100, 200, 500};
  fmt::print("scene,n,compile and write,certificate,new values,share,times new values\n");
  bool holds = true;
  for (const Case c : {Case::A, Case::BL, Case::C, Case::D, Case::F, Case::K})
    for (const int n : sizes)
      holds = titop_bench::row(c, n, quick ? 3 : std::max(20, 30000 / n)) && holds;
  return holds ? 0 : 1;
}
