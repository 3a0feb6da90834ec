#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"

/// Pairs of input and output that are 0 by symmetry: the certificate neither takes their rounding
/// for a fault, in any units, nor misses a fault in them.

using namespace titop;
using namespace titop::detail;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

const std::vector<Complex> kPoints = {{0.05, 1}, {0.2, 4}, {0.5, 10}};

/// Two equal masses on springs under a base, whose difference a push on the base cannot change; an
/// actuator between them, in units of `unit` newtons, can.
Diagram twins(double unit) {
  Diagram d{"twins"};
  auto u = d.input("u"), v = d.input("v");
  auto base = d.add("base", SpringMass{.mass = 3, .stiffness = 70, .damping = 0.3});
  auto l = d.add("l", SpringMass{.mass = 0.7, .stiffness = 13, .damping = 0.1});
  auto r = d.add("r", SpringMass{.mass = 0.7, .stiffness = 13, .damping = 0.1});
  ground(base);
  mount(l, base.child);
  mount(r, base.child);
  base.child.force += u;
  l.child.force += unit * v;
  r.child.force += -unit * v;
  d.output("between") = l.stretch - r.stretch;
  d.output("base") = base.stretch;
  return d;
}

std::vector<MatrixXcd> transfers(const StateSpace& m) {
  std::vector<MatrixXcd> list;
  for (const Complex s : kPoints) list.push_back(m.transfer(s));
  return list;
}

/// A free hub with two equal beams, mirrored: `mass` against the beams'.
Diagram mirrored(double mass, double width, double thickness, double length, double arm) {
  Diagram d{"mirrored"};
  const FlexibleBody beam = Beam{.length = length,
                                 .section = rectangle(width, thickness),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 2};
  auto U = d.input("U", 6);
  auto H = d.add("H", RigidBody{.mass = mass,
                                .inertia = mass * Vector3d(0.6, 0.7, 0.9).asDiagonal(),
                                .children = {{"L", {0, arm, 0}}, {"R", {0, -arm, 0}}}});
  auto L = d.add("L", beam), R = d.add("R", beam);
  H.parent.force = -U;
  mount(L, H.child("L"), Rotation::about({0, 0, 1}, std::numbers::pi / 2));
  mount(R, H.child("R"), Rotation::about({0, 0, 1}, -std::numbers::pi / 2));
  d.output("a", 6) = H.parent.accel;
  d.output("tip_L", 6) = L.child.accel;
  d.output("tip_R", 6) = R.child.accel;
  return d;
}

}  // namespace

TEST_CASE("a pair that is 0 by symmetry: no fault, however weak the input that does move it") {
  for (const double unit : {1.0, 1e-6, 1e-9, 3e-11, 1e-13, 1e6, 1e12}) {
    CAPTURE(unit);
    const FullCertificate c = certify(compile(twins(unit)));
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.grid.dense <= 1e-9);
    CHECK(c.grid.written <= 1e-9);
  }
}

TEST_CASE("a pair that is 0 by symmetry: a fault in it is found, in all units") {
  for (const double unit : {1e-12, 1e-9, 1e-3, 1.0, 1e3, 1e6}) {
    CAPTURE(unit);
    const System system = compile(twins(unit), {.minimize_up_to = 0});
    const StateSpace& right = system.state_space();
    StateSpace wrong = right;
    const auto l = std::find(right.states.begin(), right.states.end(), "l.stretch_rate");
    REQUIRE(l != right.states.end());
    // The left spring a millionth too stiff: the effects of the base on the two no longer cancel.
    wrong.A.row(l - right.states.begin()) *= 1 + 1e-6;
    const Measure by{{1, 1}, {1, 1}, terms(right, kPoints)};
    CHECK(by.terms(0, 0) >= 1e3 * transfers(right)[1].cwiseAbs()(0, 0));
    CHECK(difference(transfers(wrong), transfers(right), by).relative >= 1e-7);
    // And in that pair alone: the other entries as they should be.
    std::vector<MatrixXcd> alone = transfers(right);
    for (std::size_t k = 0; k < alone.size(); ++k) alone[k](0, 0) = transfers(wrong)[k](0, 0);
    CHECK(difference(alone, transfers(right), by).relative >= 1e-7);
  }
}

TEST_CASE("a pair without a path: rounding of row operations in its 0 is no fault") {
  // The first mass moves the second through a filter; nothing returns. Elimination of the second
  // one's stiffness against the filter's larger gain exchanges rows.
  for (const double gain : {-7.0, 3.0, 400.0}) {
    CAPTURE(gain);
    Diagram d{"one way"};
    auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
    auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 18});
    auto filter = d.add("filter", Lti{.D = MatrixXd{{gain}}});
    ground(a);
    ground(b);
    filter.in = a.stretch;
    a.child.force = d.input("f");
    b.child.force = d.input("g");
    b.child.force += filter.out;
    d.output("a") = a.child.accel;
    d.output("b") = b.child.accel;
    const System system = compile(d);
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.holds());
    for (const MatrixXcd& G : transfers(system.state_space(), kPoints)) {
      CHECK(G(0, 1) == 0.0);
      CHECK(std::abs(G(1, 0)) > 1e-3);
    }
  }
}

TEST_CASE("a 0 at the level of 32 digits is no fault: a loaded end without mass on a free body") {
  Diagram d{"loaded end"};
  auto a = d.add(
      "a",
      RigidBody{.mass = 3, .inertia = Eigen::Matrix3d::Identity(), .children = {{"q", {1, 1, 0}}}});
  Vector6 k;
  k << 100, 200, 300, 10, 20, 30;
  auto s = d.add("s", Bushing{.stiffness = k});
  a.parent.force = -d.input("U", 6);
  mount(s, a.child("q"));
  s.child.force += d.input("v", 6);
  d.output("stretch", 6) = s.displacement;
  const System system = compile(d);
  CHECK(system.state_space().order() == 0);
  CHECK((system.state_space().D.rightCols(6) * k.asDiagonal() - Matrix6::Identity()).norm() <=
        1e-15);
  CHECK(certify(system).faults == std::vector<std::string>{});
}

TEST_CASE("difference: blocks of three share their size, scalars have their own") {
  const auto lists = [](double off) {
    MatrixXcd G = MatrixXcd::Constant(4, 3, 1);
    G(1, 2) = 1e-9;
    G.row(3) *= 1e-6;
    MatrixXcd H = G;
    H(1, 2) += off, H(3, 0) += off;
    return std::pair(std::vector{H}, std::vector{G});
  };
  const auto [a, exact] = lists(1e-12);
  CHECK(std::abs(difference(a, exact, {{3, 1}, {3}}).relative - 1e-6) <= 1e-9);
  const auto [c, d] = lists(0);
  CHECK(difference(c, d, {{3, 1}, {3}}).relative == 0);
  std::vector<MatrixXcd> none = exact;
  none[0](0, 0) = NAN;
  CHECK(std::isinf(difference(none, exact, {{3, 1}, {3}}).relative));
}

TEST_CASE("rounding by frames of a 0 that is exact in the factors is no fault") {
  // Among the random scenes: of a torque in cu6 the factors have 0 in py12 at every s, the dense D
  // 7e-17.
  const System system =
      compile(titop::generate::random_diagram(titop::generate::random_options(2092)).build(),
              {.minimize_up_to = 100});
  const FullCertificate c = certify(system, {.points = 8});
  CAPTURE(to_string(c));
  CHECK(c.holds());
  // The same by hand: 0 next to entries of 4 and 9.
  MatrixXcd G(2, 2), H(2, 2);
  G << 0, 4, 9, 1;
  for (const auto& [left, relative] : {std::pair(6e-17, 1e-11), {6e-12, 1e-6}, {6e-3, 1e3}}) {
    CAPTURE(left);
    Measure by{{1, 1}, {1, 1}};
    H = G;
    H(0, 0) = left;
    CHECK(std::isinf(difference({H}, {G}, by).relative));
    add_rounding(by, {G}, MatrixXd::Zero(2, 2));
    CHECK(std::abs(difference({H}, {G}, by).relative / relative - 1) <= 1e-9);
  }
}

TEST_CASE("mirrored beams on a heavy hub: twins leave, and the transfer stays") {
  // Modes of the two beams, together and against each other, differ by 1e-3 to 1e-9 here.
  for (const double mass : {40.0, 1e3, 3e4, 6e5}) {
    for (const double width : {0.02, 0.035}) {
      CAPTURE(mass);
      CAPTURE(width);
      const System system = compile(mirrored(mass, width, 0.013, 1.7, 0.8));
      const FullCertificate c = certify(system, {.points = 12});
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(c.grid.dense <= 1e-9);
      // Two beams of two elements, 12 modes each.
      CHECK(system.order() == 48);
      CHECK(system.state_space().order() < 48);
    }
  }
}
