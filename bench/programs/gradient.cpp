#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/titop.hpp>

#include "support/quick.hpp"

/// Time of the derivatives of a transfer by the first stiffnesses of a row of 1000 masses, at one
/// s: by columns and rows of the opened transfer, and by all columns of w and u (System::transfer
/// of the opened model). Returns 1 if both differ by more than 1e-10 of the largest.
namespace {

using namespace titop;
using Eigen::MatrixXcd;

const std::complex<double> kAt{0.05, 2};

Diagram row(int masses) {
  Diagram d{"row"};
  std::optional<SpringMass::Handle> last;
  for (int i = 1; i <= masses; ++i) {
    const Param k = d.param(fmt::format("k{}", i), 10 + std::sin(i));
    auto z = d.add(fmt::format("z{}", i), SpringMass{.mass = 1, .stiffness = k, .damping = 0.1});
    last ? mount(z, last->child) : ground(z);
    last.emplace(z);
  }
  last->child.force += d.input("u");
  d.output("y") = last->stretch;
  return d;
}

template <class F>
double seconds_of(int runs, F f) {
  using Clock = std::chrono::steady_clock;
  double best = HUGE_VAL;
  for (int i = 0; i < runs; ++i) {
    const auto start = Clock::now();
    f();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  const System system = compile(row(quick ? 100 : 1000), {.minimize_up_to = 0});
  std::puts("parameters,way,seconds,columns solved for");
  double worst = 0;
  for (const int count : {1, 10, 100, 1000}) {
    if (quick && count > 100) continue;
    std::vector<std::string> names;
    std::vector<passes::ToOpen> to_open;
    for (int i = 1; i <= count; ++i) {
      names.push_back(fmt::format("k{}", i));
      const auto& all = system.stage().graph.parameters;
      const auto found = std::find_if(all.begin(), all.end(),
                                      [&](const auto& p) { return p.name == names.back(); });
      to_open.push_back({static_cast<int>(found - all.begin())});
    }
    const Derivatives g = derivatives(system, names);
    const System opened(detail::compile_opened(detail::data_of(system), to_open));
    TransferCost cost;
    std::vector<MatrixXcd> slopes;
    MatrixXcd M;
    const double both = seconds_of(5, [&] { slopes = g.transfers(kAt, &cost); });
    const double forward = seconds_of(count > 100 ? 1 : 3, [&] { M = opened.transfer(kAt); });
    std::puts(fmt::format("{},columns and rows,{:.3g},{}", count, both, cost.columns + cost.rows)
                  .c_str());
    std::puts(fmt::format("{},all columns,{:.3g},{}", count, forward, 3 * (count + 1)).c_str());
    // dH/dk_i = M_yw_i M_z_iu; w and z of a parameter have one name, which `opened` lists.
    const std::vector<std::string> in = opened.inputs(), out = opened.outputs();
    const auto place = [](const std::vector<std::string>& list, const std::string& name) {
      return std::find(list.begin(), list.end(), name) - list.begin();
    };
    double largest = 0, off = 0;
    for (const OpenedPairs& p : opened.stage().opened) {
      const auto i = static_cast<std::size_t>(
          std::find_if(to_open.begin(), to_open.end(),
                       [&](const passes::ToOpen& o) { return o.parameter == p.parameter; }) -
          to_open.begin());
      const std::complex<double> slope =
          M(place(out, "y"), place(in, p.name)) * M(place(out, p.name), place(in, "u"));
      largest = std::max(largest, std::abs(slope));
      off = std::max(off, std::abs(slope - slopes[i](0, 0)));
    }
    worst = std::max(worst, off / largest);
  }
  return worst <= 1e-10 ? 0 : 1;
}
