#include <doctest/doctest.h>

#include <functional>

#include "assembly.hpp"
#include "support/five_masses.hpp"

/// Integrated accelerations whose integrals are states already add none; rigid motion is integrated
/// once.

using namespace loops_test;
using namespace titop;
using titop_test::kMasses;
using titop_test::kStiffnesses;

namespace {

using Five = std::array<SpringMass::Handle, 5>;

/// Fig. 7, and the output x3 in any spelling.
Diagram five(const std::function<void(Diagram&, const Five&)>& spelling) {
  Diagram d{"five"};
  const auto add = [&](std::size_t i) {
    return d.add("z" + std::to_string(i + 1),
                 SpringMass{.mass = kMasses[i], .stiffness = kStiffnesses[i]});
  };
  const Five z{add(0), add(1), add(2), add(3), add(4)};
  auto u = d.input("u");
  ground(z[0]);
  mount(z[1], z[0].child), mount(z[2], z[0].child);
  mount(z[3], z[1].child), mount(z[4], z[1].child);
  z[0].child.force += -u;
  z[1].child.force += u;
  spelling(d, z);
  return d;
}

Complex x3_by_hand(Complex s) { return titop_test::positions(kMasses, kStiffnesses, s)(2); }

}  // namespace

TEST_CASE("five masses in every spelling: order 10, the same transfer to 1e-13") {
  const std::vector<std::pair<const char*, std::function<void(Diagram&, const Five&)>>> spellings{
      {"position", [](Diagram& d, const Five& z) { d.output("x3") = z[2].position; }},
      {"stretch", [](Diagram& d, const Five& z) { d.output("x3") = z[0].stretch + z[2].stretch; }},
      {"double integrator",
       [](Diagram& d, const Five& z) {
         auto v = d.add("v", Integrator{}), x = d.add("x", Integrator{});
         v.in = z[2].child.accel;
         x.in = v.out;
         d.output("x3") = x.out;
       }},
      {"two double integrators",
       [](Diagram& d, const Five& z) {
         auto v = d.add("v", Integrator{}), x = d.add("x", Integrator{});
         auto w = d.add("w", Integrator{}), y = d.add("y", Integrator{});
         v.in = z[2].child.accel;
         x.in = v.out;
         w.in = z[2].child.accel;
         y.in = w.out;
         d.output("x3") = 0.25 * x.out + 0.75 * y.out;
       }},
      {"integrators as matrices",
       [](Diagram& d, const Five& z) {
         const MatrixXd one = MatrixXd::Identity(1, 1);
         const Lti integral{.A = 0 * one, .B = one, .C = one};
         auto v = d.add("v", integral), x = d.add("x", integral);
         v.in = z[2].child.accel;
         x.in = v.out;
         d.output("x3") = x.out;
       }},
      {"integrated rate",
       [](Diagram& d, const Five& z) {
         auto x = d.add("x", Integrator{});
         x.in = z[2].child.rate;
         d.output("x3") = x.out;
       }},
      {"through a gain and a sum", [](Diagram& d, const Five& z) {
         auto sum = d.add("sum", Sum{.signs = "+-"});
         auto gain = d.add("gain", Gain{.gain = 4});
         auto v = d.add("v", Integrator{}), x = d.add("x", Integrator{});
         sum.in(1) = 1.0 * z[2].child.accel;
         sum.in(2) = 1.0 * z[0].child.accel;
         gain.in = sum.out;
         v.in = gain.out;
         x.in = v.out;
         d.output("x3") = z[0].position + 0.25 * x.out;
       }}};
  for (const auto& [name, spelling] : spellings) {
    CAPTURE(name);
    const System system = compile(five(spelling), {.minimize_up_to = 0});
    CHECK(system.state_space().order() == 10);
    for (const Complex s : points({1, 5, 9, 14, 30})) {
      const Complex exact = x3_by_hand(s);
      CHECK(std::abs(system.transfer(s)(0, 0) / exact - 1.0) <= 1e-13);
      CHECK(std::abs(system.state_space().transfer(s)(0, 0) / exact - 1.0) <= 1e-13);
    }
    by_hand::Structure a = by_hand::empty(5, 0, 0);
    const auto Z = titop_test::impedance(kMasses, kStiffnesses, 0);
    a.K = Z.real();
    for (Index i = 0; i < 5; ++i) a.M(i, i) = kMasses[static_cast<std::size_t>(i)];
    CHECK(by_hand::pole_error(all_poles(system), by_hand::poles(a)) <= 1e-13);
  }
}

TEST_CASE("free ring of beams: at most six rates and six positions, however many are asked for") {
  const Tube tube{1, 0.05, 0.04, 1};
  // Elastic order: 8 beams of one element, 2 * (8 * 6 - 6).
  struct Case {
    bool position_0, position_3, rate_5;
    int rigid;
  };
  for (const Case& c : {Case{false, false, false, 0}, Case{true, false, false, 12},
                        Case{true, true, true, 12}, Case{false, false, true, 6}}) {
    CAPTURE(c.rigid);
    Diagram d{"ring"};
    std::vector<BodyHandle> b;
    b.reserve(8);
    for (int i = 0; i < 8; ++i)
      b.push_back(d.add("b" + std::to_string(i), FlexibleBody{tube.beam()}));
    const Rotation T = Rotation::about({0, 0, 1}, pi / 4);
    for (std::size_t i = 0; i < 8; ++i) mount(b[(i + 1) % 8], b[i].child, T);
    b[1].child.force += T * d.input("U", 6);
    d.output("a", 6) = b[2].parent.accel;
    if (c.position_0) d.output("x0", 6) = b[0].parent.position;
    if (c.position_3) d.output("x3", 6) = b[3].child.position;
    if (c.rate_5) d.output("v5", 6) = b[5].child.rate;
    const System system = compile(d, {.minimize_up_to = 0});
    CHECK(system.order() == 84 + c.rigid);
    const Complex s{20, 300};
    const MatrixXcd exact = transfer(d.graph(), s);
    CHECK(error_3({system.transfer(s)}, {exact}) <= 1e-9);
    CHECK(error_3({system.state_space().transfer(s)}, {exact}) <= 1e-9);
  }
}

TEST_CASE("attitude control reads the hub's angles: three integrators and three more") {
  Diagram d{"attitude"};
  auto hub = d.add("hub", RigidBody{.mass = 100,
                                    .inertia = Vector3d(20, 30, 40).asDiagonal(),
                                    .children = {{"C", {1, 0, 0}}}});
  auto wing = d.add("wing", FlexibleBody{Tube{2, 0.05, 0.04, 2}.beam()});
  auto t = d.input("t", 3);
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -t;
  mount(wing, hub.child("C"));
  d.output("angle", 3) = hub.child("C").position.angular();
  d.output("rate", 3) = hub.parent.rate.angular();
  const System system = compile(d, {.minimize_up_to = 0});
  CHECK(system.order() == 24 + 6);
  const Complex s{3, 40};
  CHECK(error_3({system.transfer(s)}, {transfer(d.graph(), s)}) <= 1e-10);
  CHECK(error_3({system.state_space().transfer(s)}, {transfer(d.graph(), s)}) <= 1e-10);
}

TEST_CASE("geometry of a closed chain by a parameter: update keeps the states") {
  Diagram d{"parameter"};
  auto k = d.param("k", 30.0);
  auto z1 = d.add("z1", SpringMass{.mass = 2, .stiffness = k});
  auto z2 = d.add("z2", SpringMass{.mass = 1, .stiffness = 20});
  ground(z1);
  mount(z2, z1.child);
  z2.child.accel = 0;
  z1.child.force += d.input("u");
  d.output("x") = z1.position;
  d.output("second") = z2.stretch;
  const System system = compile(d), other = system.update({{"k", 50.0}});
  CHECK(other.states() == system.states());
  const Complex s{0.2, 3};
  CHECK(std::abs(other.transfer(s)(0, 0) * (2.0 * s * s + 70.0) - 1.0) <= 1e-14);
  CHECK(std::abs(other.state_space().transfer(s)(1, 0) * (2.0 * s * s + 70.0) + 1.0) <= 1e-14);

  Diagram g{"gear"};
  auto r = g.param("r", 2.0);
  auto a = g.add("a", SpringMass{.mass = 2, .stiffness = 30}),
       b = g.add("b", SpringMass{.mass = 1, .stiffness = 20});
  ground(a), ground(b);
  b.child.accel = r * a.child.accel;  // a lever
  a.child.force = r * b.child.force * -1.0 + g.input("u");
  g.output("x") = b.stretch;
  const System lever = compile(g);
  CHECK(lever.order() == 2);
  for (const double ratio : {2.0, 3.0}) {
    const System moved = lever.update({{"r", ratio}});
    const Complex z = (2.0 + ratio * ratio) * s * s + 30.0 + 20.0 * ratio * ratio;
    CHECK(moved.order() == 2);
    CHECK(std::abs(moved.transfer(s)(0, 0) * z / ratio - 1.0) <= 1e-14);
    CHECK(std::abs(moved.state_space().transfer(s)(0, 0) * z / ratio - 1.0) <= 1e-14);
  }
}
