#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/names.hpp"

/// certify(system, Full): confirmed results, faults found, and checks without a verdict.

using namespace titop;
using titop_test::at_s;
using titop_test::has_line;
using titop_test::has_name;
using titop_test::has_names;
using titop_test::two_digits;

namespace {

/// A free mass with another on a spring; pushed and watched at the first.
Diagram two(double damping) {
  Diagram d{"two"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 3, .stiffness = 12, .damping = damping, .parent_mass = 1});
  a.parent.force = -u;
  d.output("acc") = a.parent.accel;
  return d;
}

/// A door that turns about an axis and slides along another, both across its x axis: turned frames
/// leave rounding of the rotation about x.
Diagram door(double angle) {
  Diagram d{"door"};
  const Rotation T = Rotation::about({1, 2, 2}, angle);
  const Matrix3d R = T.nominal().transpose();
  auto B = d.add("B", RigidBody{.mass = 3,
                                .inertia = Vector3d(0.2, 0.3, 0.4).asDiagonal(),
                                .PA = {0.1, 0.2, 0.3},
                                .children = {{"pin", {0.4, 0.1, 0}}, {"E", {-0.3, 0.7, 0.5}}}});
  release(B);
  auto pin = d.add("pin", Joint{{about(R * Vector3d(0, 0.6, 0.8), "turn"),
                                 along(R * Vector3d(0.48, 0.64, -0.6), "shift")}});
  mount(pin, B.child("pin"), T);
  ground(pin.child);
  for (const char* n : {"turn", "shift"})
    pin.axis(n).force = 80.0 * pin.axis(n).position + 0.8 * pin.axis(n).rate;
  B.child("E").force += d.input("U", 6);
  d.output("a", 6) = B.child("E").accel;
  return d;
}

/// A on a sprung joint of two axes immobilised by its brace B.
Diagram braced(double angle) {
  Diagram d{"braced"};
  const Rotation T = Rotation::about({1, 2, 2}, angle);
  const Vector3d root(1, 0.3, 0.2), foot(0.1, -0.4, 0.8), far(0.7, -0.2, 0.9);
  const auto body = [](double mass, std::vector<ChildPoint> children) {
    return RigidBody{.mass = mass,
                     .inertia = Vector3d(0.2, 0.3, 0.4).asDiagonal(),
                     .PA = {0.1, 0.2, 0.3},
                     .children = std::move(children)};
  };
  auto hub = d.add("hub", body(5, {{"A", root}, {"B", foot}}));
  auto A = d.add("A", body(3, {{"far", T.nominal().transpose() * (far - root)}}));
  auto B = d.add("B", body(2, {{"far", far - foot}}));
  hub.parent.force = -d.input("U", 6);
  auto g = joint(d, "g", A, hub.child("A"), T, {about({1, 2, 3}, "p"), about({2, 0, -1}, "q")});
  for (const char* n : {"p", "q"})
    g.axis(n).force = 80.0 * g.axis(n).position + 0.8 * g.axis(n).rate;
  mount(B, hub.child("B"));
  weld(B.child, A.child, T.inverse());
  d.output("a", 6) = hub.parent.accel;
  return d;
}

/// A boom whose end is pinned to the ground, driven and read there: it only rotates.
Diagram pinned(double angle) {
  Diagram d{"pinned"};
  const Rotation T = Rotation::about({1, 2, 2}, angle), R = Rotation::about({3, -1, 2}, 2 * angle);
  auto hub = d.add("hub", RigidBody{.mass = 3,
                                    .inertia = Vector3d(0.2, 0.3, 0.4).asDiagonal(),
                                    .PA = {0.1, 0.2, 0.3},
                                    .children = {{"C", {1, 0.3, 0.2}}}});
  auto boom = d.add("boom", FlexibleBody{Beam{.length = 3,
                                              .section = rectangle(0.06, 0.04),
                                              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                              .elements = 1}});
  release(hub), mount(boom, hub.child("C"), T);
  auto h = d.add("h", Joint{{about({1, 2, 3}, "q")}});
  mount(h, boom.child, R), ground(h.child);
  h.axis("q").force = 50.0 * h.axis("q").position + 0.5 * h.axis("q").rate;
  boom.child.force += d.input("U", 6);
  d.output("a", 6) = boom.child.accel;
  return d;
}

}  // namespace

TEST_CASE("forces on pinned points move nothing, which is passive and reciprocal") {
  for (int k = 1; k <= 12; ++k) {
    CAPTURE(k);
    const FullCertificate c = certify(compile(pinned(0.2 * k), {.minimize_up_to = 0}));
    CAPTURE(to_string(c));
    CHECK(c.passivity.done);
    CHECK(c.passivity.least >= -1e-12);
    CHECK(c.reciprocity.asymmetry <= 1e-8);
    CHECK(c.holds());
  }
}

TEST_CASE("along locked axes of joints rounding gains no energy and fails no equation") {
  for (int k = 1; k <= 12; ++k) {
    CAPTURE(k);
    const System free = compile(door(0.2 * k)), held = compile(braced(0.2 * k));
    CHECK(free.order() == 4);
    CHECK(held.order() == 0);
    const FullCertificate c = certify(free);
    CHECK(c.passivity.done);
    CHECK(c.passivity.least >= -1e-12);
    CHECK(c.holds());
    CHECK(held.certificate().residual <= 1e-12);
    CHECK(certify(held).holds());
  }
}

TEST_CASE("two free masses: one pair of poles, passive, order 2, decided exactly too") {
  const FullCertificate c = certify(compile(two(0)));
  CHECK(c.holds());
  CHECK(c.grid.done);
  CHECK(c.grid.points == 24);
  CHECK(c.grid.dense <= 1e-14);
  CHECK(c.grid.written >= 0);
  CHECK(c.grid.written <= 1e-14);
  // m s^2 with m = 3 * 1 / (3 + 1): omega = 4 rad/s
  CHECK(std::abs(c.grid.lowest - 0.4) <= 1e-14);
  CHECK(std::abs(c.grid.highest - 40) <= 1e-12);
  CHECK(c.poles.count == 2);
  CHECK(c.poles.measured == 2);
  CHECK(c.poles.error <= 1e-14);
  CHECK(c.poles.right == 0);
  CHECK(c.passivity.done);
  CHECK(c.passivity.structure);
  CHECK(c.passivity.pairs == 1);
  CHECK(c.passivity.least >= 0.01);
  CHECK(c.order.decided());
  CHECK(c.order.order == 2);
  CHECK(c.exact.decided);
  CHECK(c.exact.order == 2);
  const std::string text = to_string(c);
  CHECK(has_line(text, {"2 poles", "2"}));
  CHECK(has_line(text, {"1", two_digits(c.passivity.least), at_s(c.passivity.where)}));
  CHECK(has_line(text, {"order 2"}));
  CHECK(has_line(text, {"exact", "order 2"}));
  CHECK_FALSE(has_line(text, {"FAULT"}));
}

TEST_CASE(
    "a spring between two points that are driven: poles at 0, whatever rounding makes of them") {
  // d2(stretch)/dt2 = w - v; the force that moves the mass so contains k stretch, which cancels.
  int off = 0;
  for (int k = 1; k <= 40; ++k) {
    const double stiffness = k / 7.0, mass = 0.3 + k / 11.0;
    CAPTURE(stiffness);
    Diagram d{"driven"};
    auto z = d.add("z", SpringMass{.mass = mass, .stiffness = stiffness, .damping = 0.01 * k});
    z.parent.accel = d.input("v");
    z.child.accel = d.input("w");
    d.output("stretch") = z.stretch;
    const System system = compile(d, {.minimize_up_to = 0});
    const FullCertificate c = certify(system, {.points = 6});
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.poles.count == 2);
    CHECK(c.poles.measured == 0);
    off += !system.state_space().A.row(1).isZero(0);
  }
  CHECK(off >= 5);  // rounding does make something of them
}

TEST_CASE(
    "a wrench on the child point of a bushing is dual to its acceleration, one on a parent to "
    "-it") {
  Diagram d{"isolated"};
  auto U = d.input("U", 6), V = d.input("V", 6);
  auto isolator = d.add("isolator", Bushing{.stiffness = {100, 200, 300, 10, 20, 30},
                                            .damping = {1, 2, 3, 0.1, 0.2, 0.3}});
  auto below =
      d.add("below", RigidBody{.mass = 5, .inertia = Eigen::Vector3d(4, 5, 6).asDiagonal()});
  auto body = d.add("body", RigidBody{.mass = 2, .inertia = Eigen::Vector3d(1, 2, 3).asDiagonal()});
  mount(body, isolator.child);
  mount(isolator, below.parent);
  isolator.child.force += U;
  below.parent.force += -V;
  d.output("above", 6) = isolator.child.accel;
  d.output("at V", 6) = below.parent.accel;
  const FullCertificate c = certify(compile(d));
  CHECK(c.holds());
  CHECK(c.passivity.pairs == 2);
  CHECK(c.passivity.structure);
  CHECK(c.passivity.least >= -1e-12);  // above 0 if dampers move; a free mass alone gives 0
}

TEST_CASE("a negative damper in a controller: active and unstable, and no fault of the compiler") {
  // Reads the relative speed and pushes with it.
  Diagram e{"driven"};
  auto u = e.input("u");
  auto a = e.add("a", SpringMass{.mass = 3, .stiffness = 12, .parent_mass = 1});
  auto rate = e.add("rate", Lti{.A = Eigen::MatrixXd{{-50}},
                                .B = Eigen::MatrixXd{{1}},
                                .C = Eigen::MatrixXd{{-2500}},
                                .D = Eigen::MatrixXd{{50}}});
  rate.in = a.stretch;
  a.parent.force = -u;
  a.child.force += 0.5 * rate.out;
  e.output("acc") = a.parent.accel;
  const FullCertificate c = certify(compile(e));
  CHECK(c.holds());
  CHECK(!c.passivity.structure);
  CHECK(c.poles.right == 2);
  CHECK(has_line(to_string(c), {"2", at_s(c.poles.rightmost)}));
}

TEST_CASE("omitted checks are reported, with the reason") {
  Diagram d{"unlike"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  ground(a);
  a.child.force += u;
  d.output("x") = a.stretch;
  const System system = compile(d);
  const FullCertificate c = certify(system, {.dense_up_to = 1, .written_up_to = 1});
  CHECK(!c.poles.done);
  CHECK(has_names(c.poles.why_not, {"2", "1", "Full::dense_up_to"}));
  CHECK(!c.passivity.done);
  CHECK(c.grid.written < 0);
  CHECK(!c.order.judged);
  const std::string text = to_string(c);
  for (const std::string& why : {c.poles.why_not, c.passivity.why_not, c.grid.why_not}) {
    CHECK(!why.empty());
    CHECK(text.find(why) != std::string::npos);
  }
  Diagram modes{"modes only"};
  auto z = modes.add("z", SpringMass{});
  ground(z);
  const FullCertificate m = certify(compile(modes));
  CHECK(m.grid.points == 0);
  CHECK(!m.passivity.why_not.empty());
  CHECK(!has_name(m.passivity.why_not, "Full::points"));  // another reason
  CHECK(m.holds());
}

TEST_CASE("100 random graphs: no fault, most orders decided") {
  int decided = 0, passive = 0, exact = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    const auto scene = titop::generate::random_diagram(titop::generate::random_options(seed));
    const FullCertificate c = certify(compile(scene.build()), {.points = 8});
    CAPTURE(to_string(c));
    CHECK(c.holds());
    decided += c.order.decided();
    passive += c.passivity.done;
    exact += c.exact.decided;
  }
  CHECK(decided >= 80);
  CHECK(passive >= 5);
  CHECK(exact >= 15);
}

TEST_CASE("a slow or a double pole right of the axis is not passed over") {
  const auto poles = [](const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                        const Eigen::MatrixXd& C) {
    Diagram d{"unstable"};
    auto K = d.add("K", Lti{.A = A, .B = B, .C = C});
    K.in = d.input("u");
    d.output("y") = K.out;
    return certify(compile(d), {.points = 6});
  };
  // With an integrator, six decades below the fastest: simple, and exact.
  const FullCertificate slow =
      poles((Eigen::MatrixXd(3, 3) << 1e-3, 0, 0, 0, -1e3, 0, 1, 0, 0).finished(),
            Eigen::Vector3d(1, 1, 0), Eigen::RowVector3d(0, 1, 1));
  CHECK(slow.poles.right == 1);
  CHECK(slow.poles.measured == 1);  // rounding moves it by 2e-7 of itself
  CHECK(std::abs(slow.poles.rightmost - 1e-3) <= 1e-15);
  CHECK(slow.grid.lowest <= 1e-3);
  // A defective one is not measured, and not reported as none.
  const FullCertificate twice = poles((Eigen::Matrix2d() << 1, 1, 0, 1).finished(),
                                      Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0));
  CHECK(twice.poles.measured == 0);
  CHECK(has_line(to_string(twice), {"2 poles", "0", "2"}));
}
