#include <doctest/doctest.h>

#include "assembly.hpp"

/// Chains of spring-masses that close through the ground.

using namespace loops_test;
using namespace titop;

namespace {

const std::vector<double> kM{1.3, 0.7, 1.9, 0.5, 1.1, 0.9}, kK{61, 97, 55, 83, 71, 66};

/// Masses in a row between two walls: the last mass is the second wall's.
Diagram walls(const std::vector<double>& m, const std::vector<double>& k, bool inputs) {
  Diagram d{"walls"};
  std::vector<SpringMass::Handle> z;
  z.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    z.push_back(d.add("z" + std::to_string(i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z[i], z[i - 1].child);
  }
  z.back().child.accel = 0;
  if (!inputs) return d;
  z[1].child.force += d.input("u");
  d.output("x2") = z[1].position;
  d.output("x5") = z[4].position;
  d.output("last") = z[5].stretch;  // one of them depends on the others
  d.output("R") = z.back().child.force;
  d.output("a3") = z[2].child.accel;
  return d;
}

by_hand::Structure walls_by_hand() {
  by_hand::Structure a = by_hand::empty(5, 1, 3);
  for (Index i = 0; i < 6; ++i) {
    const double k = kK[static_cast<std::size_t>(i)];
    if (i < 5) a.M(i, i) = kM[static_cast<std::size_t>(i)], a.K(i, i) += k;
    if (i == 0) continue;
    a.K(i - 1, i - 1) += k;
    if (i < 5) a.K(i, i - 1) -= k, a.K(i - 1, i) -= k;
  }
  a.B(1, 0) = 1;
  a.C(0, 1) = a.C(1, 4) = 1;
  a.C(2, 4) = -1;
  return a;
}

}  // namespace

TEST_CASE("six masses between two walls: order 10, poles as M and K") {
  const System modes = compile(walls(kM, kK, false));
  CHECK(modes.state_space().order() == 10);
  CHECK(by_hand::pole_error(all_poles(modes), by_hand::poles(walls_by_hand())) <= 1e-12);
  for (const Pole& p : modes.poles()) CHECK(p.omega > 1);
}

TEST_CASE("six masses between two walls: transfer, dependent stretch and wall force") {
  const System system = compile(walls(kM, kK, true));
  const by_hand::Structure a = walls_by_hand();
  CHECK(system.order() == 10);
  CHECK(system.state_space().order() == 10);
  std::vector<MatrixXcd> exact, factored, dense;
  for (const Complex s : points({0.001, 1, 4, 8, 12, 20, 90})) {
    MatrixXcd y = by_hand::position_transfer(a, s);
    // Force of the wall on mass 6: it does not move, spring 6 pulls it with k6 * stretch.
    const Complex R = kK[5] * y(2, 0);
    const Complex x3 = by_hand::position_transfer(
        [&] {
          by_hand::Structure b = a;
          b.C.setZero();
          b.C(0, 2) = 1;
          return b;
        }(),
        s)(0, 0);
    y.conservativeResize(5, 1);
    y(3) = R;
    y(4) = s * s * x3;
    exact.push_back(y);
    factored.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
  }
  CHECK(by_hand::transfer_error(factored, exact) <= 1e-12);
  CHECK(by_hand::transfer_error(dense, exact) <= 1e-12);
  const MatrixXcd rest = by_hand::position_transfer(a, 0);
  CHECK(by_hand::transfer_error({system.static_gain().topRows(3).cast<Complex>()}, {rest}) <=
        1e-13);
  CHECK(system.dense_certificate().dense_against_factors <= 1e-14);
  CHECK(system.dense_certificate().dense_error <= 1e-12);
}

TEST_CASE("apply, write and descriptor of a closed chain are the same model") {
  const System system = compile(walls(kM, kK, true), {.minimize_up_to = 0});
  StateSpace m;
  system.write(m);
  REQUIRE(m.states == system.states());
  const VectorXd x = VectorXd::LinSpaced(10, -1, 2), u = VectorXd::Constant(1, 0.7);
  const System::Rates r = system.apply(x, u);
  CHECK((r.xdot - m.A * x - m.B * u).cwiseAbs().maxCoeff() <= 1e-12 * m.A.cwiseAbs().maxCoeff());
  CHECK((r.y - m.C * x - m.D * u).cwiseAbs().maxCoeff() <= 1e-12 * m.C.cwiseAbs().maxCoeff());
  const Descriptor d = system.descriptor();
  CHECK(d.states == 10);
  CHECK(d.names[10].substr(0, 1) == "z");
  const Complex s{0.3, 7};
  const MatrixXcd pencil = s * MatrixXcd(d.E.cast<Complex>()) - MatrixXcd(d.A.cast<Complex>());
  const MatrixXcd G =
      MatrixXcd(d.C.cast<Complex>()) * pencil.fullPivLu().solve(MatrixXcd(d.B.cast<Complex>())) +
      MatrixXcd(d.D.cast<Complex>());
  CHECK(by_hand::transfer_error({G}, {system.transfer(s)}) <= 1e-12);
}

TEST_CASE("a wall that an input moves keeps its states") {
  for (const bool both : {false, true}) {
    Diagram d{"moved"};
    auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 30});
    auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 20});
    auto u = d.input("u");
    if (both)
      a.parent.accel = d.input("v");
    else
      ground(a);
    mount(b, a.child);
    b.child.accel = u;
    d.output("x") = a.stretch;
    d.output("f") = b.child.force;
    // The wall's position is the double integral of u: both stretches are needed.
    CHECK(compile(d).order() == 4);
  }
}

TEST_CASE("both walls on one shaker: the sum of the stretches stays 0") {
  Diagram d{"shaker"};
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 30});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 20});
  auto u = d.input("u");
  a.parent.accel = u;
  mount(b, a.child);
  b.child.accel = u;
  d.output("x") = a.stretch;
  const System system = compile(d);
  CHECK(system.order() == 2);
  const Complex s{0.2, 3};
  CHECK(std::abs(system.transfer(s)(0, 0) * (2.0 * s * s + 50.0) / (-2.0) - 1.0) <= 1e-14);
}

TEST_CASE("five masses in a ring in space: order 8") {
  // Springs i between masses i and i + 1, and one between masses 5 and 1.
  Diagram d{"ring"};
  std::vector<SpringMass::Handle> z;
  z.reserve(5);
  for (int i = 0; i < 5; ++i)
    z.push_back(
        d.add("z" + std::to_string(i), SpringMass{.mass = kM[static_cast<std::size_t>(i)],
                                                  .stiffness = kK[static_cast<std::size_t>(i)]}));
  for (int i = 0; i < 5; ++i)
    mount(z[static_cast<std::size_t>(i)], z[static_cast<std::size_t>((i + 4) % 5)].child);
  const System modes = compile(d);
  CHECK(modes.state_space().order() == 8);
  by_hand::Structure a = by_hand::empty(5, 0, 0);
  for (Index i = 0; i < 5; ++i) {
    const double k = kK[static_cast<std::size_t>(i)];
    const Index p = (i + 4) % 5;
    a.M(i, i) = kM[static_cast<std::size_t>(i)];
    a.K(i, i) += k, a.K(p, p) += k, a.K(i, p) -= k, a.K(p, i) -= k;
  }
  CHECK(by_hand::pole_error(all_poles(modes), elastic_poles(a, 1)) <= 1e-12);
}

TEST_CASE("a lever between two masses, by a factor, a Gain or a static Lti: order 2") {
  for (const int spelling : {0, 1, 2}) {
    CAPTURE(spelling);
    Diagram d{"lever"};
    auto u = d.input("u");
    auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 30});
    auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 20});
    ground(a), ground(b);
    auto gain = d.add("gain", Gain{.gain = 2});
    auto lti = d.add("lti", Lti{.D = MatrixXd{{2}}});
    gain.in = a.child.accel;
    lti.in = a.child.accel;
    if (spelling == 0) b.child.accel = 2 * a.child.accel;
    if (spelling == 1) b.child.accel = gain.out;
    if (spelling == 2) b.child.accel = lti.out;
    a.child.force = u - 2 * b.child.force;
    d.output("x") = a.stretch;
    const System system = compile(d);
    CHECK(system.order() == 2);
    const Complex s{0.3, 1.1};  // (m_a + 4 m_b) s^2 + k_a + 4 k_b
    CHECK(std::abs(system.transfer(s)(0, 0) * (6.0 * s * s + 110.0) - 1.0) <= 1e-15);
  }
}
