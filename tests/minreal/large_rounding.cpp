#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <titop/titop.hpp>

/// Entries of A, B, C, D of which rounding may be a third, but which are decisive: they are no
/// zeros, and the model without them is another.

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// (s + 7) / (s + 1), with a feedback gain near 1.
Diagram loop(double g) {
  Diagram d{"loop"};
  auto L = d.add(
      "L",
      Lti{.A = MatrixXd{{-1.0}}, .B = MatrixXd{{2.0}}, .C = MatrixXd{{3.0}}, .D = MatrixXd{{1.0}}});
  L.in = g * L.out + d.input("u");
  d.output("y") = L.out;
  return d;
}

/// An acceleration fed back so that a mass of 2 is nearly cancelled.
Diagram nearly_massless(double kd) {
  Diagram d{"nearly_massless"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 5, .damping = 0.1});
  auto w = d.add("w", SpringMass{.mass = 1, .stiffness = 3, .damping = 0.2});
  ground(z);
  mount(w, z.child);
  z.child.force += -kd * z.child.accel + d.input("u");
  d.output("x") = w.stretch + z.stretch;
  d.output("f") = w.parent.force;
  return d;
}

/// Two bodies, closed into a chain by a hinge and a bushing, and a mass on a weak spring.
Diagram soft_in_a_chain(double k, double mass) {
  Diagram d{"soft_in_a_chain"};
  auto B = d.add(
      "B",
      RigidBody{.mass = 5, .inertia = {1, 2, 3}, .children = {{"c", {1, 0, 0}}, {"e", {0, 1, 0}}}});
  auto A =
      d.add("A", RigidBody{.mass = 3, .inertia = {0.3, 0.4, 0.5}, .children = {{"t", {-1, 1, 0}}}});
  B.parent.force = -d.input("U", 6);
  auto h = hinge(d, "h", A, B.child("c"), {}, {0, 0, 1});
  auto z = d.add("z", SpringMass{.mass = mass, .stiffness = k, .damping = 0.1, .parent_mass = 0.5});
  mount(z, A.child("t").along({0, 1, 0}));
  auto bushing = d.add("bushing", Bushing{.stiffness = 10 * Matrix6::Identity()});
  mount(bushing, B.child("e"));
  auto E = d.add(
      "E", RigidBody{.mass = mass, .inertia = {0.1, 0.1, 0.1}, .children = {{"q", {0, 0, 0}}}});
  mount(E, bushing.child);
  weld(E.child("q"), A.child("t"));
  h.torque = 5.0 * h.angle + 0.4 * z.stretch;
  d.output("zz") = 0.3 * z.child.position;
  return d;
}

/// The largest error of an output, relative to its value in 50 digits, at each point by itself.
double worst_error(const System& system, const StateSpace& m, const std::vector<Complex>& points) {
  double worst = 0;
  for (const Complex s : points) {
    const MatrixXcd exact = system.transfer(s, Precision::digits50), G = m.transfer(s);
    for (Eigen::Index i = 0; i < G.rows(); ++i)
      worst = std::max(worst, (G.row(i) - exact.row(i)).norm() / exact.row(i).norm());
  }
  return worst;
}

StateSpace written(const System& system) {
  StateSpace m;
  system.write(m);
  return m;
}

const std::vector<Complex> kPoints = {{0.03, 0.1}, {0.3, 1.1}, {0.5, 10}, {40, 100}};

}  // namespace

TEST_CASE("minimal: a loop of all but 1 is no loop of nothing") {
  for (const double left : {1e-9, 1e-13, 1e-14, -1e-14, 4e-15}) {
    CAPTURE(left);
    const double g = 1 - left;
    const System system = compile(loop(g));
    const StateSpace& m = system.state_space();
    CHECK(m.order() == 1);
    for (const Complex s : {Complex(0.3, 1.1), Complex(0, 0.01), Complex(5, 30)}) {
      // y = L u / (1 - g L), with 1 - g as double has it.
      const Complex exact = (s + 7.0) / ((1 - g) * s + 1.0 - 7 * g);
      CAPTURE(s);
      CHECK(std::abs(system.transfer(s)(0, 0) / exact - 1.0) <= 1e-14);
      // D and C (s - A)^-1 B are 1 / left, and cancel down to about 1.
      CHECK(std::abs(m.transfer(s)(0, 0) / exact - 1.0) <=
            8 * std::numeric_limits<double>::epsilon() / std::abs(left));
    }
  }
}

TEST_CASE("minimal: of a mass that feedback all but takes away four states stay") {
  for (const double left : {1e-9, 1e-12, 1e-14}) {
    CAPTURE(left);
    const System system = compile(nearly_massless(-2 - left));
    CHECK(system.state_space().order() == 4);
    CHECK(worst_error(system, system.state_space(), kPoints) <=
          10 * worst_error(system, written(system), kPoints) + 1e-9);
  }
}

TEST_CASE("minimal: a soft spring in a closed chain: no less right than the model as written") {
  for (const double k : {1e-12, 1e-10, 1e-8})
    for (const double mass : {1e3, 1e5, 1e6}) {
      CAPTURE(k);
      CAPTURE(mass);
      const System system = compile(soft_in_a_chain(k, mass));
      const double as_written = worst_error(system, written(system), kPoints);
      CHECK(as_written <= 0.1);
      CHECK(worst_error(system, system.state_space(), kPoints) <= 10 * as_written + 1e-9);
    }
}
