#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>

#include "methods/steppers.hpp"
#include "scenes/satellite.hpp"
#include "support/energy.hpp"
#include "support/quick.hpp"

/// Conservation and drift of time steps, compared with theory: energy of undamped structures over a
/// million steps, a closed chain that must stay closed, growth per step, limits of stability.
/// Returns 1 if growth or a limit differs from theory.
namespace titop_bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop::Diagram;
using titop::SpringMass;
using titop::StateSpace;
using titop::Stepper;
using titop::System;

void row(const char* test, const char* scene, const char* method, double x, double value,
         double theory) {
  fmt::print("{},{},{},{:.4g},{:.4g},{:.4g}\n", test, scene, method, x,
             std::isfinite(value) ? value : 1e300, theory);
  std::fflush(stdout);
}

/// Takes a number of steps from a state.
using March = std::function<VectorXd(const VectorXd&, int)>;

March by_library(const System& system, Stepper stepper, double h) {
  return [&system, stepper, h](const VectorXd& x0, int steps) {
    VectorXd x = x0;
    for (int done = 0; done < steps; done += 10000) {  // a trajectory in memory at a time
      const int n = std::min(10000, steps - done);
      x = simulate(system, titop::Excitation::none(),
                   {.step = h, .until = n * h, .stepper = stepper, .x0 = x})
              .x;
    }
    return x;
  };
}

March by_hand(const Step& step) {
  return [step](const VectorXd& x0, int steps) {
    VectorXd x = x0;
    for (int k = 0; k < steps; ++k) x = step(x);
    return x;
  };
}

// --- energy -------------------------------------------------------------------------------------

/// |E/E0 - 1| after 1, 10, ... steps.
void energy_of(const char* scene, const char* method, const Energy& energy, Index states,
               const March& march, int most) {
  VectorXd x = energy.bent(states);
  const double before = energy(x);
  int done = 0;
  for (int steps = 10; steps <= most; steps *= 10) {
    x = march(x, steps - done);
    done = steps;
    const double off = std::abs(energy(x) / before - 1);
    // Rounding: a step changes it by no more than a unit of the last place per state.
    row("energy", scene, method, steps, off, steps * (static_cast<double>(states) * 0x1p-53));
  }
}

struct Plant {
  System system;
  StateSpace model = {};
  explicit Plant(const Diagram& d) : system(compile(d, {.minimize_up_to = 0})) {
    system.write(model);
  }
};

void energies(const char* scene, const Diagram& d, int most, bool small) {
  const Plant p(d);
  const Energy energy(p.model);
  const double h = 1 / energy.fastest();
  const auto run = [&](const char* method, const March& march) {
    energy_of(scene, method, energy, p.model.A.rows(), march, most);
  };
  run("midpoint", by_library(p.system, Stepper::midpoint, h));
  if (!small) return;  // the others go through a dense A
  run("exact", by_library(p.system, Stepper::exact, h));
  run("Newmark", by_hand(newmark(p.model, h)));
  run("rk4", by_hand(runge_kutta(p.model, h)));
  run("explicit Euler", by_hand(explicit_euler(p.model, h)));
}

/// [Alazard 2015] Fig. 7.
Diagram five_masses() {
  Diagram d{"five masses"};
  auto u = d.input("u");
  const auto body = [&](const char* name, double mass, double stiffness) {
    return d.add(name, SpringMass{.mass = mass, .stiffness = stiffness});
  };
  auto z1 = body("z1", 1, 10), z2 = body("z2", 2, 26), z3 = body("z3", 3, 33);
  auto z4 = body("z4", 4, 20), z5 = body("z5", 5, 95);
  ground(z1);
  mount(z2, z1.child), mount(z3, z1.child), mount(z4, z2.child), mount(z5, z2.child);
  z2.child.force += u;
  d.output("x3") = z1.stretch + z3.stretch;
  return d;
}

/// Spring-masses in a row on the ground; `wall`: the last one stands at another wall.
Diagram masses(int n, bool wall) {
  Diagram d{"row of masses"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      SpringMass{.mass = 1 + 0.3 * (i % 3), .stiffness = 100.0 + 7 * (i % 5)}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
  }
  if (wall) z.back().child.accel = 0;
  z.front().child.force += u;
  auto sum = 1.0 * z[0].stretch;
  for (std::size_t i = 1; i < z.size(); ++i) sum = sum + z[i].stretch;
  d.output("gap") = sum;
  return d;
}

// --- a chain that must stay closed
// ----------------------------------------------------------------

/// The model of masses(6, true) in stretches and rates: s_i'' = a_i - a_(i-1) with the walls'
/// accelerations 0 and m_i a_i = k_(i+1) s_(i+1) - k_i s_i. No equation makes the sum of the
/// stretches 0; the initial sum and its rate are kept, as two poles at 0.
StateSpace of_accelerations() {
  StateSpace m;
  m.A = MatrixXd::Zero(12, 12);
  const auto k = [](Index i) { return 100.0 + 7 * static_cast<double>(i % 5); };
  for (Index i = 0; i < 6; ++i) m.A(2 * i, 2 * i + 1) = 1;
  for (Index i = 0; i < 5; ++i) {
    const double mass = 1 + 0.3 * static_cast<double>(i % 3);
    for (const auto& [row, sign] : {std::pair{2 * i + 1, 1.0}, std::pair{2 * i + 3, -1.0}}) {
      m.A(row, 2 * i + 2) += sign * k(i + 1) / mass;
      m.A(row, 2 * i) -= sign * k(i) / mass;
    }
  }
  return m;
}

/// Six masses between two walls: the stretches sum to 0.
void closures(bool quick) {
  const Plant p(masses(6, true));
  const StateSpace naive = of_accelerations();
  const double h = 0.1 / 20;
  VectorXd start = VectorXd::Zero(12);
  for (Index i = 0; i < 5; ++i) start(2 * i) = i % 2 ? -0.1 : 0.1;
  start(10) = -0.1;  // +0.1 - 0.1 + 0.1 - 0.1 + 0.1 - 0.1
  const int most = quick ? 1000 : 1000000;
  const auto gaps = [&](const char* method, const March& march, VectorXd x, bool open) {
    int done = 0;
    for (int steps = 10; steps <= most; steps *= 10) {
      x = march(x, steps - done);
      done = steps;
      double gap = 0;
      if (open)
        for (Index i = 0; i < 12; i += 2) gap += x(i);
      else
        gap = p.system.apply(x, VectorXd::Zero(1)).y(0);
      row("closure", "six masses", method, steps, std::abs(gap) / 0.1, 0);
    }
  };
  VectorXd kept(p.system.order());
  for (Index i = 0; i < kept.size(); ++i) {
    const std::string& name = p.system.states()[static_cast<std::size_t>(i)];
    const bool stretch = name.find("rate") == std::string::npos;
    kept(i) = stretch ? start(2 * (name.at(1) - '1')) : 0;
  }
  gaps("titop exact", by_library(p.system, Stepper::exact, h), kept, false);
  gaps("titop midpoint", by_library(p.system, Stepper::midpoint, h), kept, false);
  gaps("accelerations by Newmark", by_hand(newmark(naive, h)), start, true);
  gaps("accelerations by rk4", by_hand(runge_kutta(naive, h)), start, true);
}

// --- growth and limits
// ----------------------------------------------------------------------------

using Complex = std::complex<double>;
struct Rule {
  const char* name;
  Complex (*factor)(Complex z);  ///< of one step on xdot = p x, z = h p
  Step (*step)(const StateSpace&, double);
};

Complex rk4_factor(Complex z) {
  return 1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)));
}

const Rule kRules[] = {
    {"Newmark", [](Complex z) { return (1.0 + z / 2.0) / (1.0 - z / 2.0); }, newmark},
    {"rk4", rk4_factor, runge_kutta},
    {"explicit Euler", [](Complex z) { return 1.0 + z; }, explicit_euler},
};

/// A mass of natural frequency 1 rad/s.
StateSpace oscillator(double damping) {
  StateSpace m;
  m.A.resize(2, 2);
  m.A << 0, 1, -1, -2 * damping;
  return m;
}

/// Spectral radius of one step, from its matrix on two states.
double growth(const March& march) {
  Eigen::Matrix2d end;
  for (Index i = 0; i < 2; ++i) end.col(i) = march(VectorXd::Unit(2, i), 1);
  return end.eigenvalues().cwiseAbs().maxCoeff();
}

/// True if measurement and theory agree.
bool agree(double measured, double theory, double tolerance) {
  return std::abs(measured - theory) <= tolerance * theory;
}

bool growths() {
  Diagram d{"oscillator"};
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 1});
  ground(z);
  z.child.force += d.input("u");
  d.output("x") = z.stretch;
  const Plant p(d);
  bool right = true;
  for (double x = 0.03; x < 11; x *= std::pow(10, 0.125)) {
    const auto compare = [&](const char* name, const March& march, double theory) {
      const double measured = growth(march);
      row("growth", "oscillator", name, x, measured, theory);
      right = right && agree(measured, theory, 1e-12);
    };
    for (const Rule& r : kRules)
      compare(r.name, by_hand(r.step(p.model, x)), std::abs(r.factor({0, x})));
    compare("exact", by_library(p.system, Stepper::exact, x), 1);
    compare("midpoint", by_library(p.system, Stepper::midpoint, x), 1);
  }
  return right;
}

/// The largest h omega at which `grows` is false, between two ends.
double bisect(const std::function<bool(double)>& grows) {
  double inside = 1e-6, outside = 100;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(inside * outside);
    (grows(middle) ? outside : inside) = middle;
  }
  return inside;
}

/// Checks the limits of steps taken and of the factor.
bool limits() {
  bool right = true;
  for (const double damping : {0.01, 0.03, 0.1, 0.3, 1.0}) {
    const StateSpace m = oscillator(damping);
    const Complex pole(-damping, std::sqrt(1 - damping * damping));
    for (const Rule& r : kRules) {
      if (r.step == newmark) continue;  // none
      const double measured =
          bisect([&](double h) { return growth(by_hand(r.step(m, h))) > 1 + 1e-13; });
      const double theory =
          bisect([&](double h) { return std::abs(r.factor(h * pole)) > 1 + 1e-13; });
      row("limit", "oscillator", r.name, damping, measured, theory);
      right = right && agree(measured, theory, damping == 1 ? 1e-6 : 1e-9);
    }
  }
  return right;
}

bool all(bool quick) {
  const int most = quick ? 1000 : 1000000;
  energies("five masses", five_masses(), most, true);
  const titop::fe::ModeOptions modes{.kept = 6, .residual = {"P"}};
  energies("satellite", scenes::satellite(scenes::read_boom(modes), nullptr, 0), most, true);
  energies("1000 masses", masses(quick ? 100 : 1000, false), quick ? 100 : 10000, false);
  closures(quick);
  const bool grow = growths(), limit = limits();
  return grow && limit;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  fmt::print("test,scene,method,x,value,theory\n");
  return titop_bench::all(titop_bench::is_quick(argc, argv)) ? 0 : 1;
}
