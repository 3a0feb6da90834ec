#include <doctest/doctest.h>

#include <cmath>
#include <titop/analysis/certify/structure.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "support/notes.hpp"

/// Certificates of degenerate cases: zero A, gain, output, number of inputs or of points; and of
/// instability outside the structure.

using namespace titop;
using titop_test::at_s;
using titop_test::has_line;
using titop_test::has_name;
using titop_test::outputs_lose_digits;
using titop_test::two_digits;

namespace {

Eigen::MatrixXd one(double x) { return Eigen::MatrixXd::Constant(1, 1, x); }

/// A mass on a spring, pushed and watched.
SpringMass::Handle mass(Diagram& d) {
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4, .damping = 0.1});
  ground(z);
  z.child.force += d.input("u");
  d.output("a") = z.child.accel;
  return z;
}

/// Two masses, and a controller with an integrator in its loop, which a gain of 0 cuts open.
Diagram cut_open(bool sees_controller) {
  Diagram d{"cut open"};
  auto z = d.add("z", SpringMass{.mass = 1.3308787541014468,
                                 .stiffness = 0.5611413617652939,
                                 .damping = 2.8599781246444476});
  auto y = d.add(
      "y", SpringMass{
               .mass = 1.1156522348129911, .stiffness = 0.86, .damping = 0.5, .parent_mass = 2.45});
  auto G = d.add("G", Gain{.gain = 0});
  auto S = d.add("S", Sum{.signs = "+-"});
  auto I = d.add("I", Integrator{});
  ground(z), mount(y, z.child);
  G.in = S.out;
  S.in(1) = z.child.rate;
  S.in(2) = -1.0 * I.out;
  I.in = G.out;
  z.child.force += d.input("u");
  y.child.force += G.out;
  d.output("y") = y.stretch;
  if (sees_controller) d.output("x") = I.out, d.output("g") = G.out;
  return d;
}

}  // namespace

TEST_CASE("integrators alone: poles at 0, exactly, and a grid of frequencies") {
  Diagram d{"integrator"};
  auto I = d.add("I", Integrator{});
  I.in = d.input("u");
  d.output("y") = I.out;
  Diagram e{"free"};
  auto body = e.add("body", RigidBody{.mass = 2, .inertia = {1, 2, 3}});
  body.parent.force = -e.input("u", 6);
  e.output("v", 6) = body.parent.rate;
  for (const System& system : {compile(d), compile(e)}) {
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.poles.count == system.order());
    CHECK(c.poles.measured == c.poles.count);
    CHECK(c.poles.error == 0);
    CHECK(c.poles.right == 0);
    CHECK(c.grid.done);
    CHECK(c.grid.lowest > 0);
    CHECK(c.grid.highest > c.grid.lowest);
    CHECK(has_line(to_string(c), {fmt::format("{} poles", c.poles.count)}));
  }
}

TEST_CASE("a loop opened by a gain of 0: rounding of its signals is no residual") {
  const System system = compile(cut_open(false));
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(certify(system).holds());
  CHECK(compile(cut_open(true)).certificate().residual <= 1e-12);
}

TEST_CASE("a loop that a gain of 0 cuts open: a signal that is more than rounding breaks it") {
  const auto data = detail::compile_graph(cut_open(false).graph(), {});
  const Graph& g = data->graph();
  detail::Evaluation<double> point(*data, 0.85, solve::RowMatrix<double>::Ones(1, 1));
  detail::Signals right{detail::first_of_signals(g)};
  right.values = point.values(right.first);
  right.unknowns = point.unknowns();
  right.rounding = point.rounding_of_values(right.first);
  right.s = 0.85;
  CHECK(detail::written_residual(*data, right).worst <= 1e-12);
  for (std::size_t i = 0; i < g.signals.size(); ++i) {
    const std::string name = name_of(g, static_cast<int>(i));
    if (name != "I.in" && name != "G.out") continue;
    CAPTURE(name);
    detail::Signals off = right;
    off.values(right.first[i]) = 1e-10;  // z moves with 0.1 m/s
    CHECK(detail::written_residual(*data, off).worst >= 0.1);
  }
}

TEST_CASE("outputs that are 0 by cancellation have lost no digit") {
  for (const double part : {-1.0, 0.3, 1.0, -0.5}) {
    CAPTURE(part);
    Diagram d{"zero"};
    auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 2, .damping = 0.5});
    auto G = d.add("G", Gain{.gain = 0});
    auto S = d.add("S", Sum{.signs = "+-"});
    auto I = d.add("I", Integrator{});
    ground(z);
    G.in = S.out;
    S.in(1) = z.child.rate;
    S.in(2) = part * I.out;
    I.in = G.out;
    z.child.force += d.input("u") + G.out;
    d.output("y") = z.stretch;
    d.output("x") = I.out;
    d.output("g") = G.out;
    CHECK(!outputs_lose_digits(compile(d)));
  }
  CHECK(!outputs_lose_digits(compile(cut_open(true))));
}

TEST_CASE("a one-way block that grows is no fault of the structure that it reads") {
  Diagram filter{"filter"};
  auto z = mass(filter);
  auto K = filter.add("K", Lti{.A = one(0.5), .B = one(1), .C = one(1)});
  K.in = z.stretch;
  filter.output("z") = K.out;
  Diagram alone{"alone"};
  auto L = alone.add("L", Lti{.A = one(2), .B = one(1), .C = one(1)});
  L.in = alone.input("u");
  alone.output("y") = L.out;
  Diagram loop{"loop"};
  auto I = loop.add("I", Integrator{});
  I.in = 0.5 * I.out + mass(loop).stretch;
  loop.output("y") = I.out;
  for (const Diagram* d : {&filter, &alone, &loop}) {
    const FullCertificate c = certify(compile(*d));
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.poles.right == 1);
    CHECK(c.poles.hidden == 0);
    CHECK(has_line(to_string(c), {"1", at_s(c.poles.rightmost)}));
    CHECK(!certification::has_poles_of_bodies_only(d->graph()));
  }
  // A structure with an integrator on a sensor must still have none on the right.
  Diagram sensed{"sensed"};
  auto J = sensed.add("J", Integrator{});
  J.in = mass(sensed).stretch;
  sensed.output("y") = J.out;
  CHECK(certification::has_poles_of_bodies_only(sensed.graph()));
  CHECK(certify(compile(sensed)).holds());
}

TEST_CASE("hidden unstable poles are reported") {
  Diagram d{"hidden"};
  auto u = d.input("u");
  // d(x)/dt = x and d(y)/dt = -y; the output depends on y alone.
  auto K = d.add("K", Lti{.A = (Eigen::Matrix2d() << 0, 1, 1, 0).finished(),
                          .B = Eigen::Vector2d(1, 0),
                          .C = Eigen::RowVector2d(1, -1)});
  K.in = u;
  d.output("y") = K.out;
  const FullCertificate c = certify(compile(d));
  CAPTURE(to_string(c));
  CHECK(c.order.order == 1);
  CHECK(c.poles.right == 1);
  CHECK(c.poles.hidden == 1);
  CHECK(has_line(to_string(c), {"WARNING"}));
  Diagram e{"dangling"};
  auto L = e.add("L", Lti{.A = one(1), .B = one(1), .C = one(1)});
  L.in = mass(e).stretch;
  const FullCertificate of_dangling = certify(compile(e));
  CHECK(of_dangling.poles.count == 2);
  CHECK(has_name(of_dangling.poles.why_not, "1"));
  CHECK(has_line(to_string(of_dangling), {"2 poles", of_dangling.poles.why_not}));
}

TEST_CASE("a force that moves others and not its own point is not passive") {
  // G = [0 3g; 0 g], g > 0 at real s: the Hermitian part is indefinite.
  Diagram d{"lever"};
  auto u1 = d.input("u1"), u2 = d.input("u2");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 4});
  ground(a), ground(b);
  b.child.force = u2;
  a.child.accel = 3 * b.child.accel;
  a.child.force += u1;
  d.output("a1") = a.child.accel;
  d.output("a2") = b.child.accel;
  const FullCertificate c = certify(compile(d));
  CHECK(c.passivity.done);
  CHECK(!c.passivity.structure);
  CHECK(c.passivity.least <= -0.1);
  CHECK(has_line(to_string(c), {two_digits(c.passivity.least), at_s(c.passivity.where)}));
}

TEST_CASE("without inputs the equations are checked all the same, where there is an instant") {
  Diagram d{"modes"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 7});
  ground(a), mount(b, a.child);
  d.output("x") = a.stretch;
  const auto data =
      std::const_pointer_cast<detail::SystemData>(detail::compile_graph(d.graph(), {}));
  CHECK(data->checked().certificate.at_instant);
  CHECK(data->checked().certificate.residual >= 0);
  CHECK(data->checked().certificate.residual <= 1e-14);
  // Other numbers than those that the factors were made of.
  for (auto& block : data->numbers.blocks) {
    auto other = std::make_shared<Dynamics>(*block);
    other->D *= 1.001;
    block = other;
  }
  CHECK(detail::certify(*data).certificate.residual > detail::kWarn);
  const System system = compile(d);
  CHECK(system.dense_certificate().dense_error < 0);
  CHECK(!has_name(to_string(system.dense_certificate()), two_digits(-1)));  // not shown as an error
}

TEST_CASE("omitted checks have no number: no inputs and no instant, no points") {
  Diagram d{"no instant"};
  auto b = d.add("b", RigidBody{.mass = 2, .inertia = {1, 2, 3}});
  b.parent.force = 3.0 * b.parent.position;
  d.output("x", 6) = b.parent.accel;
  const Certificate c = compile(d).certificate();
  CHECK(c.residual < 0);
  CHECK(!has_name(to_string(c), two_digits(-1)));  // not shown as a residual
  CHECK(compile(Diagram{"empty"}).certificate().residual < 0);
  Diagram e{"pushed"};
  mass(e);
  const System system = compile(e);
  for (const int points : {0, -1}) {
    const FullCertificate none = certify(system, {.points = points});
    CHECK(none.grid.points == 0);
    CHECK(none.holds());
    for (const std::string& why :
         {none.grid.why_not, none.passivity.why_not, none.reciprocity.why_not})
      CHECK(has_name(why, "Full::points"));
  }
}
