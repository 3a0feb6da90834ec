#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "methods/steppers.hpp"
#include "support/cases.hpp"
#include "support/quick.hpp"

/// Error against cost of time integration: the free motion of a chain released from a bent shape,
/// by the library's steppers and by others. Steps are given as h * omega of the fastest pole; the
/// error is the largest difference of a state at the end from the exact motion, over the largest
/// state. Methods that fail are shown, however large their error.
namespace titop_bench {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using titop::StateSpace;
using titop::Stepper;
using titop::System;

struct Motion {
  System system;
  StateSpace model = {};
  VectorXd x0 = {};
  double fastest = 0;  ///< [rad/s]

  Motion(Case c, int n) : system(compile(case_diagram(c, n), {.minimize_up_to = 0})) {
    system.write(model);
    x0 = VectorXd::Zero(system.order());
    for (Index i = 0; i < x0.size(); ++i)  // coordinates: their rows have one entry, for their rate
      if ((model.A.row(i).array() != 0).count() == 1) x0(i) = 1e-2;
    for (const titop::Pole& p : poles(model)) fastest = std::max(fastest, p.omega);
  }
};

/// State at the end, and the seconds of all steps.
struct Run {
  VectorXd x;
  double seconds = 0;
};

template <class F>
Run timed(F f) {
  const auto start = std::chrono::steady_clock::now();
  VectorXd x = f();
  const std::chrono::duration<double> all = std::chrono::steady_clock::now() - start;
  return {std::move(x), all.count()};
}

Run by_library(const Motion& m, Stepper stepper, double h, int steps) {
  return timed([&] {
    return VectorXd(simulate(m.system, titop::Excitation::none(),
                             {.step = h, .until = steps * h, .stepper = stepper, .x0 = m.x0})
                        .x);
  });
}

Run by_hand(const Motion& m, const Step& step, int steps) {
  return timed([&] {
    VectorXd x = m.x0;
    for (int k = 0; k < steps; ++k) x = step(x);
    return x;
  });
}

void compare(Case c, int n, bool quick) {
  const Motion m(c, n);
  const int most = quick ? 256 : 8192;
  const double shortest = 0.05 / m.fastest;
  const VectorXd exact = by_library(m, Stepper::exact, most * shortest, 1).x;
  const auto row = [&](const char* method, double h, const Run& run) {
    const double off = (run.x - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
    fmt::print("{},{},{},{:.4g},{:.3g},{:.4g}\n", name_of(c), n, method, h * m.fastest,
               std::isfinite(off) ? off : 1e300, run.seconds);
  };
  for (int steps = most; steps >= 16; steps /= 2) {
    const double h = shortest * most / steps;
    row("exact", h, by_library(m, Stepper::exact, h, steps));
    row("midpoint", h, by_library(m, Stepper::midpoint, h, steps));
    if (h <= rk4_limit(m.system)) row("rk4", h, by_library(m, Stepper::rk4, h, steps));
    row("rk4 unguarded", h, by_hand(m, runge_kutta(m.model, h), steps));
    row("Newmark", h, by_hand(m, newmark(m.model, h), steps));
    row("explicit Euler", h, by_hand(m, explicit_euler(m.model, h), steps));
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  using titop_bench::Case;
  fmt::print("scene,n,method,h_omega,error,seconds\n");
  titop_bench::compare(Case::A, 10, quick);
  titop_bench::compare(Case::D, 5, quick);
  if (!quick) titop_bench::compare(Case::D, 50, quick);
}
