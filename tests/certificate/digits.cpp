#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <titop/titop.hpp>

#include "report/markup.hpp"
#include "support/mistakes.hpp"

/// Rounding error of A, B, C, D: the full certificate measures it, and judges it as the report and
/// generated code do.

using namespace titop;
using titop_test::at_s;
using titop_test::has_line;
using titop_test::has_name;
using titop_test::two_digits;

namespace {

using Complex = std::complex<double>;
using Long = std::complex<long double>;

bool all_hold(const System& system, int full_up_to) {
  const std::string page = report_html(system, {.diagrams = false, .full_up_to = full_up_to});
  return titop_test::verdicts(page).at(1).cls == "good";
}

bool is_exported(const System& system) {
  try {
    generate_cpp(system);
    return true;
  } catch (const Error& error) {
    CHECK(titop_test::says(error, Code::bad_value, {"A, B, C, D"}));
    return false;
  }
}

/// A mass of 1 kg on a spring, and a heavy one on it by another.
Diagram heavy(double mass) {
  Diagram d{"heavy"};
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 1e6, .damping = 1});
  auto z2 = d.add("z2", SpringMass{.mass = mass, .stiffness = 2e6, .damping = 3});
  ground(z1), mount(z2, z1.child);
  z2.child.force += d.input("u");
  d.output("x") = z2.child.position;
  return d;
}

/// By hand, in long double: [s^2 + 4 s + 3e6, -3 s - 2e6; -3 s - 2e6, m s^2 + 3 s + 2e6] x = [0;
/// u].
Complex heavy_moves(double mass, Complex at) {
  const Long s(at), a = s * s + 4.0L * s + 3e6L, b = 3.0L * s + 2e6L;
  return Complex(a / (a * (static_cast<long double>(mass) * s * s + b) - b * b));
}

/// Error of the dense model over the certificate's grid and at the frequencies of the poles,
/// relative to the largest value there.
double off_over_grid(const System& system, const FullCertificate::Grid& grid, double mass) {
  const StateSpace& dense = system.state_space();
  std::vector<double> omegas;
  for (int k = 0; k < grid.points; ++k)
    omegas.push_back(grid.lowest * std::pow(grid.highest / grid.lowest, k / (grid.points - 1.0)));
  for (const Pole& p : system.poles()) omegas.push_back(p.omega);
  double off = 0, peak = 0;
  for (const double w : omegas) {
    const Complex s(0.05 * w, w), right = heavy_moves(mass, s);
    off = std::max(off, std::abs(dense.transfer(s)(0, 0) - right));
    peak = std::max(peak, std::abs(right));
  }
  return off / peak;
}

/// One bay of a truss that floats: bars from a hub, a diagonal and a cross bar close two chains.
Diagram frame() {
  Diagram d{"frame"};
  const auto bar = [](double length) {
    return FlexibleBody{Beam{.length = length,
                             .section = tube(0.04, 0.036),
                             .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                             .elements = 2,
                             .modes = {.xi = {0.005}}}};
  };
  const double wide = 0.6, long_ = 0.8, turn = std::atan2(wide, long_);
  auto hub = d.add("hub", RigidBody{.mass = 200,
                                    .inertia = Vector3d(30, 40, 50).asDiagonal(),
                                    .children = {{"A", {0.5, 0.3, 0}}, {"B", {0.5, -0.3, 0}}}});
  auto top = d.add("top", bar(long_)), bottom = d.add("bottom", bar(long_)),
       cross = d.add("cross", bar(wide)), diagonal = d.add("diagonal", bar(1));
  auto dish = d.add("dish", RigidBody{.mass = 12, .inertia = Vector3d(2, 3, 4).asDiagonal()});
  hub.parent.force = -d.input("F", 6);
  mount(top, hub.child("A")), mount(bottom, hub.child("B"));
  mount(diagonal, hub.child("B"), Rotation::about({0, 0, 1}, turn));
  weld(diagonal.child, top.child, Rotation::about({0, 0, 1}, turn));
  mount(cross, bottom.child, Rotation::about({0, 0, 1}, std::numbers::pi / 2));
  weld(cross.child, top.child, Rotation::about({0, 0, 1}, std::numbers::pi / 2));
  mount(dish, top.child);
  d.output("hub", 6) = hub.parent.accel;
  d.output("corner", 6) = bottom.child.accel;
  return d;
}

}  // namespace

TEST_CASE("digits that the dense model has lost are measured as they are") {
  for (const double mass : {1e9, 1e10, 1e11, 1e12}) {
    CAPTURE(mass);
    const System system = compile(heavy(mass), {.minimize_up_to = 0});
    const FullCertificate c = certify(system);
    const double off = off_over_grid(system, c.grid, mass);
    CAPTURE(off);
    CHECK(off >= 1e-8);
    CHECK(std::abs(c.grid.dense - off) <= 1e-3 * off);
  }
}

TEST_CASE("rounding error of A, B, C, D: certificate, report and generated code agree") {
  int lost = 0;
  for (const double mass : {1.0, 1e3, 1e6, 1e8, 1e11, 1e12}) {
    CAPTURE(mass);
    const System system = compile(heavy(mass));
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.holds() == is_exported(system));
    CHECK(c.holds() == all_hold(system, 100));
    CHECK(c.holds() == all_hold(system, 0));
    CHECK(has_name(certificate_json(c), c.holds() ? "\"holds\": true" : "\"holds\": false"));
    if (c.holds()) continue;
    ++lost;
    CHECK(has_line(to_string(c), {"FAULT", "A, B, C, D", at_s(c.basic.dense_error_s),
                                  two_digits(c.basic.dense_error), "System::transfer"}));
  }
  CHECK(lost == 2);
}

TEST_CASE("digits lost where outputs of a floating frame are small are reported, and no fault") {
  const System system = compile(frame());
  const FullCertificate c = certify(system);
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(is_exported(system));
  CHECK(all_hold(system, 0));
  CHECK(c.basic.dense_error <= 0.1 * c.basic.dense_error_where_small);
  CHECK(has_line(to_string(c.basic), {two_digits(c.basic.dense_error_where_small),
                                      at_s(c.basic.dense_error_where_small_s)}));
}

TEST_CASE("a pole that grows shows that a force is not passive, if it is in its motion") {
  // Two free masses that repel each other with 13 - 1 N/m: s^2 = 12 / (3 * 1 / (3 + 1)) = 16.
  Diagram d{"repelled"};
  auto a = d.add("a", SpringMass{.mass = 3, .stiffness = 1, .parent_mass = 1});
  a.parent.force = 13.0 * a.stretch - d.input("u");
  a.child.force += 13.0 * a.stretch;
  d.output("acc") = a.parent.accel;
  const FullCertificate c = certify(compile(d));
  CAPTURE(to_string(c));
  CHECK(c.poles.right == 1);
  CHECK(std::abs(c.poles.rightmost - 4.0) <= 1e-12);
  CHECK(c.poles.hidden == 0);
  CHECK(c.passivity.done);
  CHECK(c.passivity.least <= -0.01);
  CHECK(std::abs(c.passivity.where - 4.0) <= 0.5);
  CHECK(has_line(to_string(c), {"1", two_digits(c.passivity.least), at_s(c.passivity.where)}));
}

TEST_CASE("a pole that grows beside a structure, or unseen, takes nothing from its passivity") {
  Diagram beside{"beside"};
  auto z = beside.add("z", SpringMass{.mass = 1, .stiffness = 4, .damping = 0.1});
  ground(z);
  z.child.force += beside.input("u");
  auto K = beside.add("K", Lti{.A = Eigen::MatrixXd::Constant(1, 1, 0.5),
                               .B = Eigen::MatrixXd::Ones(1, 1),
                               .C = Eigen::MatrixXd::Ones(1, 1)});
  K.in = z.stretch;
  beside.output("a") = z.child.accel;
  beside.output("y") = K.out;
  const FullCertificate c = certify(compile(beside));
  CAPTURE(to_string(c));
  CHECK(c.poles.right == 1);
  CHECK(c.poles.hidden == 0);
  CHECK(c.holds());
  CHECK(c.passivity.least >= -1e-9);
  CHECK(has_line(to_string(c), {"1", two_digits(c.passivity.least), at_s(c.passivity.where)}));
}
