#include "support/five_masses.hpp"

#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/close.hpp"

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

// As the README prints it.
Diagram five_masses() {  // [Alazard 2015] Fig. 7, Table 1 right
  Diagram d{"five masses"};
  auto u = d.input("u");                                              // actuator force [N]
  auto z1 = d.add("z1", SpringMass{.mass = 1.0, .stiffness = 10.0});  // [kg], [N/m]
  auto z2 = d.add("z2", SpringMass{.mass = 2.0, .stiffness = 26.0});
  auto z3 = d.add("z3", SpringMass{.mass = 3.0, .stiffness = 33.0});
  auto z4 = d.add("z4", SpringMass{.mass = 4.0, .stiffness = 20.0});
  auto z5 = d.add("z5", SpringMass{.mass = 5.0, .stiffness = 95.0});

  z1.parent.accel = 0;  // the wall
  z2.parent.accel = z1.child.accel;
  z3.parent.accel = z1.child.accel;
  z4.parent.accel = z2.child.accel;
  z5.parent.accel = z2.child.accel;
  z1.child.force = z2.parent.force + z3.parent.force - u;
  z2.child.force = z4.parent.force + z5.parent.force + u;

  d.output("x3") = z1.stretch + z3.stretch;  // position of mass 3 [m]
  return d;
}

}  // namespace

TEST_CASE("the five masses as printed give the transfer of M and K assembled by hand") {
  const System system = compile(five_masses());
  const StateSpace& m = system.state_space();
  CHECK(m.order() == 10);
  CHECK(m.inputs == std::vector<std::string>{"u"});
  CHECK(m.outputs == std::vector<std::string>{"x3"});
  for (const Complex s : {Complex(0, 0), Complex(0, 1.7), Complex(0.4, 2.9), Complex(-0.2, 12)}) {
    const Complex exact = positions({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95}, s)(2);
    CHECK(relative(m.transfer(s)(0, 0), exact) <= 1e-12);
    CHECK(relative(system.transfer(s)(0, 0), exact) <= 1e-12);
  }
}

TEST_CASE("five masses: poles, acceleration of mass 3 and static positions") {
  const System system = compile(five_masses_scene(kMasses, kStiffnesses));
  CHECK(system.state_space().order() == 10);
  const auto poles = system.poles();
  const Five omega{4.55256989, 9.03311238, 12.34116247, 16.39759640, 18.94707178};
  REQUIRE(poles.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(poles[i].pair);
    CHECK(poles[i].s.real() == 0);
    CHECK(relative(poles[i].s.imag(), omega[i]) <= 1.2e-9);  // they carry 9 to 10 digits
  }
  const int a3 = system.state_space().output("a3");
  CHECK(relative(system.transfer({0, 3})(a3, 0), Complex(-0.00768447565408)) <= 1e-12);
  const Eigen::MatrixXd x = system.static_gain();
  const Five still{0, 1.0 / 300, 0, 1.0 / 300, 1.0 / 300};
  for (int i = 0; i < 5; ++i)
    CHECK(std::abs(x(i, 0) - still[static_cast<std::size_t>(i)]) <= 1e-15 / 300);
}

TEST_CASE("five masses: two equal appendages leave 8 of 10 states") {
  const Five m{1, 2, 3, 4, 5}, k{10, 26, 33, 20, 25};  // k4/m4 = k5/m5
  const System system = compile(five_masses_scene(m, k));
  CHECK(system.order() == 10);
  const StateSpace& model = system.state_space();
  CHECK(model.order() == 8);
  for (const Complex s : {Complex(0, 1.1), Complex(0.5, 4)}) {
    const auto exact = positions(m, k, s);
    CHECK(matrix_error(model.transfer(s).topRows(5), exact) <= 1e-11);
  }
}

TEST_CASE("Fig. 12: one block inverted below, one above") {
  Diagram d{"Fig. 12"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 3.0, .stiffness = 50.0, .parent_mass = 2.0});
  auto z2 = d.add("z2", SpringMass{.mass = 1.5, .stiffness = 80.0});
  z1.parent.force = -u;  // m0 is free
  z2.parent.accel = z1.child.accel;
  z1.child.force = z2.parent.force;
  z2.child.accel = 0;  // m2 is locked
  d.output("a1") = z1.child.accel;
  d.output("a0") = z1.parent.accel;
  d.output("lock") = z2.child.force;
  const System system = compile(d);
  const StateSpace& m = system.state_space();
  CHECK(m.order() == 4);
  const auto poles = system.poles();
  REQUIRE(poles.size() == 2);
  CHECK(relative(poles[0].s, Complex(0, 3.433724513)) <= 2e-10);
  CHECK(relative(poles[1].s, Complex(0, 7.519499272)) <= 1e-10);
  const Eigen::Vector3cd exact(-0.565326633166, -1.164572864322, -5.025125628141);
  CHECK(matrix_error(m.transfer({0, 3}), exact) <= 2e-12);
  CHECK(matrix_error(system.transfer({0, 3}), exact) <= 2e-12);
  int inverted = 0;
  for (const Note& n : system.notes()) inverted += n.kind == Note::Kind::inverted;
  CHECK(inverted == 2);
}
