#include <doctest/doctest.h>

#include <algorithm>
#include <titop/titop.hpp>
#include <utility>

#include "support/notes.hpp"

/// A slow block with rigid bodies in a closed chain: its frequency, which decides where a system
/// is tried, is so low that the factors have no digit there. The assembly's own frequencies count.

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

/// Hub, arm on a sprung hinge, and back by a bushing; the hub is pushed. `closing`: the mass that
/// closes the chain.
struct Chain {
  Diagram d{"chain"};
  RigidBody::Handle hub = d.add(
      "hub",
      RigidBody{.mass = 5, .inertia = {1, 2, 3}, .children = {{"c", {1, 0, 0}}, {"e", {0, 1, 0}}}});
  RigidBody::Handle arm = d.add(
      "arm", RigidBody{.mass = 3, .inertia = {0.3, 0.4, 0.5}, .children = {{"t", {-1, 1, 0}}}});
  Hinge::Handle h = hinge(d, "h", arm, hub.child("c"), {}, {0, 0, 1});

  explicit Chain(double closing = 2) {
    hub.parent.force = -d.input("U", 6);
    auto bushing = d.add("bushing", Bushing{.stiffness = MatrixXd::Identity(6, 6) * 10});
    mount(bushing, hub.child("e"));
    auto end = d.add(
        "end",
        RigidBody{.mass = closing, .inertia = {0.1, 0.1, 0.1}, .children = {{"q", {0, 0, 0}}}});
    mount(end, bushing.child);
    weld(end.child("q"), arm.child("t"));
    d.output("a", 6) = hub.parent.accel;
    d.output("angle") = h.angle;
  }
};

Diagram with_pendulum(double mass, double stiffness, double damping) {
  Chain c;
  c.h.torque = 5 * c.h.angle;
  auto z = c.d.add("z", SpringMass{.mass = mass, .stiffness = stiffness, .damping = damping});
  mount(z, c.arm.child("t").along({0, 1, 0}));
  c.d.output("z") = z.child.position;
  return std::move(c.d);
}

Diagram with_filter(double pole) {
  Chain c;
  c.h.torque = 5 * c.h.angle;
  const auto one = [](double x) { return MatrixXd::Constant(1, 1, x); };
  auto slow = c.d.add("slow", Lti{.A = one(-pole), .B = one(pole), .C = one(1)});
  slow.in = c.h.angle;
  c.d.output("filtered") = slow.out;
  return std::move(c.d);
}

/// Largest error of the model at these s relative to the row's largest entry there, against 50
/// digits: the chain's arms are whole numbers, so that 50 digits close it.
double error(const System& system, const StateSpace& m, std::initializer_list<double> omegas) {
  double worst = 0;
  for (const double w : omegas) {
    const std::complex<double> s(0.05 * w, w);
    const MatrixXcd exact = system.transfer(s, Precision::digits50);
    const Eigen::VectorXd size = exact.rowwise().lpNorm<Eigen::Infinity>(),
                          off = (m.transfer(s) - exact).rowwise().lpNorm<Eigen::Infinity>();
    worst = std::max(worst, (off.array() / size.array()).maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "slow block: a model is written, minimized and certified though no digit is at its pole") {
  int left_out = 0;
  const auto check = [&](const Diagram& d) {
    const System system = compile(d);
    CHECK(error(system, system.state_space(), {0.1, 1, 10}) <= 3e-6);
    CHECK(static_cast<int>(system.poles().size()) > 0);
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.grid.done);
    CHECK(c.grid.dense <= 1e-7);
    left_out += c.grid.points < 24;
    CHECK(c.grid.points > 0);
    CHECK((c.grid.points == 24) == c.grid.why_not.empty());
    CHECK(to_string(c).find(c.grid.why_not) != std::string::npos);
  };
  check(with_pendulum(10, 0, 1e-3));
  check(with_pendulum(1, 0, 1e-5));
  check(with_pendulum(2, 1e-10, 1e-7));
  check(with_pendulum(1000, 0, 1e-5));
  check(with_pendulum(2, 0, 1e-7));
  for (const double pole : {1e-5, 1e-6, 1e-7}) check(with_filter(pole));
  CHECK(left_out >= 2);
}

TEST_CASE("slow block: where the factors have no digit, a transfer is refused, not found by luck") {
  // In rotated frames the last place of the arms decides there: in 50 digits the chain does not
  // close exactly, and the remainder constrains it.
  const System system = compile(with_filter(1e-6));
  for (const double w : {1e-8, 1e-9}) CHECK_THROWS_AS(system.transfer({0.05 * w, w}), Error);
  CHECK(system.transfer({0, 1e-3}).allFinite());
}

namespace {

/// True if the certificate or the log reports lost digits of the model.
bool told(const System& system) {
  const Certificate c = system.dense_certificate();
  return std::max(c.dense_error, c.dense_error_where_small) > 1e-6 ||
         titop_test::dense_not_tried(system);
}

Diagram with_heavy_end(double mass, double stiffness) {
  Chain c(mass);
  auto z = c.d.add("z", SpringMass{.mass = mass, .stiffness = stiffness, .damping = 0.1});
  mount(z, c.arm.child("t").along({0, 1, 0}));
  c.h.torque = 5 * c.h.angle + 0.4 * z.stretch;
  c.d.output("z") = z.child.position;
  return std::move(c.d);
}

}  // namespace

TEST_CASE("slow block: a model that is wrong at the modes of the assembly is reported") {
  int wrong = 0;
  for (const double mass : {1e3, 1e6, 1e8, 1e10})
    for (const double stiffness : {0.0, 1e-12, 1e-3}) {
      CAPTURE(mass);
      CAPTURE(stiffness);
      const System system = compile(with_heavy_end(mass, stiffness));
      StateSpace written;
      system.write(written);
      const double off = error(system, written, {1e-3, 0.1, 1}),
                   minimal = error(system, system.state_space(), {1e-3, 0.1, 1});
      CHECK(minimal <= 10 * std::max(off, 1e-9));  // removing states loses no further digits
      if (off <= 1e-3) continue;
      ++wrong;
      CHECK(told(system));
    }
  CHECK(wrong >= 4);
}
