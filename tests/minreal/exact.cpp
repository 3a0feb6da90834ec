#include <doctest/doctest.h>
#include <fmt/format.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <boost/multiprecision/miller_rabin.hpp>
#include <cmath>
#include <random>
#include <titop/compiler/definition/exact/residue.hpp>
#include <titop/titop.hpp>

#include "support/five_masses.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// The order in exact arithmetic, against the theory of each scene.

using namespace titop;
using Eigen::MatrixXd;
using titop_test::has_names;
using titop_test::noted;

namespace {

/// Fig. 7 with an actuator between masses 1 and 2 and the position of mass 3; in units of `unit`.
Diagram five(double k5, double unit = 1) {
  titop_test::Five m = titop_test::kMasses, k = titop_test::kStiffnesses;
  k[4] = k5;
  for (std::size_t i = 0; i < 5; ++i) m[i] *= unit, k[i] *= unit;
  return titop_test::third_of_five(m, k);
}

/// Two equal wings on a free hub of six degrees of freedom, along +x and turned by T: their
/// opposite motions cancel in the hub where T turns one wing into the other's place.
Diagram winged(const Rotation& T) {
  ModalData wing;
  wing.omega = Eigen::Vector2d(2, 8);
  wing.xi = Eigen::Vector2d::Zero();
  wing.L_P = MatrixXd::Zero(2, 6);
  wing.L_P(0, 1) = 0.5, wing.L_P(0, 5) = 1.25;
  wing.L_P(1, 2) = 0.25, wing.L_P(1, 4) = -0.75;
  wing.D_P = MatrixXd::Zero(6, 6);
  wing.D_P.diagonal() << 4, 4, 4, 8, 16, 16;
  Diagram d{"winged hub"};
  auto u = d.input("u", 6);
  auto hub = d.add("hub", RigidBody{.mass = 8,
                                    .inertia = Eigen::Vector3d(4, 4, 4).asDiagonal(),
                                    .children = {{"C1", {0, 0, 0}}, {"C2", {0, 0, 0}}}});
  auto w1 = d.add("w1", FlexibleBody{wing}), w2 = d.add("w2", FlexibleBody{wing});
  hub.parent.force = -u;
  mount(w1, hub.child("C1"));
  mount(w2, hub.child("C2"), T);
  d.output("a", 6) = hub.parent.accel;
  return d;
}

}  // namespace

TEST_CASE("five masses: 8 where k4/m4 = k5/m5, decided exactly; 10 one ulp beside it") {
  const ExactOrder equal = exact_order(five(130).graph());
  CHECK(equal.decided);
  CHECK(equal.order == 8);
  CHECK(exact_order(five(std::nextafter(130, 200)).graph()).order == 10);
  CHECK(exact_order(five(std::nextafter(130, 0)).graph()).order == 10);
  CHECK(exact_order(five(170).graph()).order == 10);
  CHECK(exact_order(five(130, 0x1p-40).graph()).order == 8);
  // Otherwise a mode below its own rounding is removed.
  CHECK(compile(five(std::nextafter(130, 200))).state_space().order() == 8);
  const System exactly = compile(five(std::nextafter(130, 200)), {.exact_up_to = 10});
  CHECK(exactly.state_space().order() == 10);
  CHECK(noted(exactly, Note::Kind::info, "minimize", {"exact", "order 10"}));
  const System even = compile(five(130), {.exact_up_to = 10});
  CHECK(even.state_space().order() == 8);
  CHECK(noted(even, Note::Kind::info, "minimize", {"exact", "order 8"}));
}

TEST_CASE(
    "exact arithmetic that is asked for up to more states than minimize has them all judged") {
  const System system = compile(five(130), {.minimize_up_to = 5, .exact_up_to = 10});
  CHECK(system.state_space().order() == 8);
  CHECK(system.order_verdict().exact);
  CHECK(compile(five(130), {.minimize_up_to = 5}).state_space().order() == 10);
  CHECK(compile(five(130), {.minimize_up_to = 0, .exact_up_to = 10}).state_space().order() == 10);
}

TEST_CASE("five masses, k5/m5 beside k4/m4: order 8 by effect, and the interval reaches to 10") {
  CHECK(compile(five(130)).order_verdict().decided());
  // Visible above its rounding, and far narrower than the spacing of doubles at the pole.
  for (const double apart : {1e-12, 1e-10, 1e-9, 1e-8}) {
    CAPTURE(apart);
    const Diagram d = five(130 * (1 + apart));
    const System system = compile(d);
    const OrderVerdict& v = system.order_verdict();
    REQUIRE(exact_order(d.graph()).order == 10);
    CHECK(system.state_space().order() == 8);
    CHECK(v.lowest == 8);
    CHECK(v.highest == 10);
    REQUIRE(v.removed.size() == 1);
    CHECK(v.removed[0].visibility > v.removed[0].bound);
    CHECK(has_names(to_string(v), {"order 8", "8", "10"}));
    CHECK(certify(system).holds());
  }
  // One ulp is less than rounding: exact arithmetic finds it, and that is no fault of the model.
  const FullCertificate one = certify(compile(five(std::nextafter(130, 200))));
  CHECK(one.holds());
  CHECK(one.exact.order == 10);
  CHECK(one.order.lowest == 8);
  CHECK(one.order.highest == 10);
}

TEST_CASE("six masses between walls: 10 of 12 are reached, all are seen") {
  Diagram d{"walls"};
  auto u = d.input("u");
  const double m[] = {1.3, 0.7, 1.9, 0.5, 1.1, 0.9}, k[] = {61, 97, 55, 83, 71, 66};
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 6; ++i) {
    z.push_back(d.add("z" + std::to_string(i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
    i == 0 ? ground(z[0]) : mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
  }
  z[5].child.accel = 0;
  z[2].child.force += u;
  d.output("x") = z[1].stretch;
  const ExactOrder r = exact_order(d.graph());
  CHECK(r.decided);
  CHECK(r.order == 10);
  CHECK(r.reachable == 10);
  CHECK(r.observable == 12);
}

TEST_CASE("six degrees of freedom: turns of 90 degrees and of 3-4-5 triangles are exact") {
  // Equal wings at one point: only the sum of each pair of modes moves the hub.
  const ExactOrder same = exact_order(winged(Rotation{}).graph());
  CHECK(same.decided);
  CHECK(same.order == 4);
  // Turned about z, the two wings push the hub in directions that are not parallel.
  const double c = 0.6, s = 0.8;
  const Rotation T = Rotation::matrix(Eigen::Matrix3d{{c, -s, 0}, {s, c, 0}, {0, 0, 1}});
  const ExactOrder turned = exact_order(winged(T).graph());
  CHECK(turned.decided);
  CHECK(turned.order == 8);
  const ExactOrder right =
      exact_order(winged(Rotation::about({0, 0, 1}, 2 * std::atan(1.0))).graph());
  CHECK(right.decided);
  CHECK(right.order == 8);
}

TEST_CASE("residues are rational numbers modulo two primes") {
  using exact::Residue;
  std::mt19937_64 generator;
  for (const std::uint64_t prime : Residue::kPrimes)
    CHECK(boost::multiprecision::miller_rabin_test(boost::multiprecision::cpp_int(prime), 25,
                                                   generator));
  CHECK(Residue(0.25) + Residue(0.5) == Residue(0.75));
  CHECK(Residue(0.1) + Residue(0.2) != Residue(0.3));
  CHECK(Residue(-3) * Residue(-3).inverse() == 1);
  CHECK(Residue(0x1p-1074) * Residue(0x1p1000) * Residue(0x1p74) == 1);
  CHECK(Residue(0x1p61) != 1);
  CHECK(Residue(1.0) - Residue(std::nextafter(1.0, 2)) == -Residue(0x1p-52));
  CHECK_THROWS_AS(Residue(0).inverse(), exact::Undecided);
}

TEST_CASE("numbers of 53 bits: a hundred coupled states, and a hundred that follow from fifty") {
  titop_test::Rng rng(7);
  const auto order = [](const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
    StateSpace m{A, B, C, MatrixXd::Zero(1, 1), {}, {"u"}, {"y"}};
    for (int i = 0; i < A.rows(); ++i) m.states.push_back(fmt::format("x{}", i));
    return exact_order(m).order;
  };
  const MatrixXd coupled = rng.matrix(100, 100), driven = rng.matrix(100, 1);
  CHECK(order(coupled, driven, rng.matrix(1, 100)) == 100);
  // The same part twice: the difference of the two is not moved.
  const MatrixXd A = rng.matrix(50, 50), B = rng.matrix(50, 1);
  MatrixXd twice = MatrixXd::Zero(100, 100), both(100, 1);
  twice.topLeftCorner(50, 50) = twice.bottomRightCorner(50, 50) = A;
  both << B, B;
  CHECK(order(twice, both, rng.matrix(1, 100)) == 50);
  twice(70, 70) = std::nextafter(twice(70, 70), 10);
  CHECK(order(twice, both, rng.matrix(1, 100)) == 100);
}

TEST_CASE("undecided exact orders have a reason") {
  const ExactOrder turned = exact_order(winged(Rotation::about({0, 0, 1}, 0.7)).graph());
  CHECK(!turned.decided);
  CHECK(has_names(turned.why_not, {"w2.parent"}));
  CHECK(to_string(turned).find(turned.why_not) != std::string::npos);
  CHECK(has_names(exact_order(five(130).graph(), {.states = 11}).why_not,
                  {"12", "11", "ExactOptions::states"}));
  CHECK(has_names(exact_order(five(130).graph(), {.unknowns = 20}).why_not,
                  {"20", "ExactOptions::unknowns"}));
  Diagram no_input{"no input"};
  auto z = no_input.add("z", SpringMass{});
  ground(z);
  no_input.output("x") = z.position;
  const ExactOrder none = exact_order(no_input.graph());
  CHECK(!none.decided);
  CHECK(!none.why_not.empty());
  CHECK(none.why_not.find("ExactOptions") == std::string::npos);
  Diagram twice{"weightless"};  // a force on a point without mass moves it infinitely
  auto u = twice.input("u");
  auto s = twice.add("s", SpringMass{.mass = 1, .stiffness = 1});
  s.parent.force = -u;
  twice.output("a") = s.parent.accel;
  const ExactOrder improper = exact_order(twice.graph());
  CHECK(!improper.decided);
  CHECK(!improper.why_not.empty());
  CHECK(improper.why_not != none.why_not);
  CHECK(improper.why_not.find("ExactOptions") == std::string::npos);
}

TEST_CASE("given matrices: order of random models, enlarged by states without effect") {
  titop_test::Rng rng(5);
  for (int round = 0; round < 40; ++round) {
    // The core is a chain of integrators with feedback, minimal by its form; then unreachable
    // states and unobservable states, coupled at random, and a mixing by integers.
    const int n = 1 + rng.below(4), p = rng.below(3), q = rng.below(3), all = n + p + q;
    const auto whole = [&] { return static_cast<double>(rng.below(7) - 3); };
    StateSpace m;
    m.A = MatrixXd::Zero(all, all), m.B = MatrixXd::Zero(all, 1), m.C = MatrixXd::Zero(1, all);
    for (int i = 0; i + 1 < n; ++i) m.A(i, i + 1) = 1;
    for (int j = 0; j < n; ++j) m.A(n - 1, j) = whole();
    m.B(n - 1, 0) = 1;
    m.C(0, 0) = 1;
    for (int i = 0; i < all; ++i)
      for (int j = n; j < n + p; ++j)
        if (i < n || i >= n + p || j <= i) m.A(i, j) = whole();  // not moved, but acting
    for (int i = n + p; i < all; ++i) {
      for (int j = 0; j < all; ++j) m.A(i, j) = whole();  // moved, but not acting
      m.B(i, 0) = whole();
    }
    for (int j = n; j < n + p; ++j) m.C(0, j) = whole();
    MatrixXd T = MatrixXd::Identity(all, all), inverse = T;
    for (int k = 0; k < 3 * all; ++k) {
      const int i = rng.below(all), j = rng.below(all);
      if (i == j) continue;
      const double f = whole();
      T.row(i) += f * T.row(j);
      inverse.col(j) -= f * inverse.col(i);
    }
    REQUIRE(T * inverse == MatrixXd(MatrixXd::Identity(all, all)));
    m.A = (T * m.A * inverse).eval(), m.B = (T * m.B).eval(), m.C = (m.C * inverse).eval();
    CAPTURE(round);
    CHECK(exact_order(m).order == n);
  }
}

TEST_CASE("beams whose numbers are no fractions of two, held at the tip: two per direction held") {
  for (const int held : {1, 3, 6}) {
    CAPTURE(held);
    Diagram d{"held beam"};
    auto u = d.input("u", 6);
    const Beam beam{.length = 1.3,
                    .section = tube(0.04, 0.03),
                    .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                    .elements = 2};
    auto b = d.add("b", FlexibleBody{beam});
    auto load = d.add("load", FlexibleBody{beam});
    ground(b);
    mount(load, b.child);
    if (held == 1) load.child.accel.along({0, 0, 1}) = 0, release(load.child);
    if (held == 3) load.child.accel.linear = 0, load.child.force.angular = 0;
    if (held == 6) load.child.accel = 0;
    b.child.force += u;
    d.output("a", 6) = b.child.accel;
    const ExactOrder exact = exact_order(d.graph(), {.states = 60});
    CHECK(exact.decided);
    // Two bodies of two elements have 12 modes each. If both ends of the row fix its length, or its
    // twist, one mode of that kind has its node in the middle, where the force acts and the motion
    // is read.
    const int with_node = held == 6 ? 2 : held == 3 ? 1 : 0;
    CHECK(exact.order == 2 * (24 - held - with_node));
    CHECK(compile(d).order() == 2 * (24 - held));
  }
}

TEST_CASE("a point locked by modes of rank 4: order 4 of 12, exactly, and no fault") {
  titop_test::Rng rng(3);
  const auto random = [&](int rows, int cols) {
    MatrixXd m(rows, cols);
    for (double& x : m.reshaped()) x = rng.between(-1, 1);
    return m;
  };
  ModalData m;
  m.omega = Eigen::VectorXd::LinSpaced(6, 3, 20);
  m.xi = Eigen::VectorXd::Constant(6, 0.01);
  m.L_P = 0.3 * random(6, 6);
  m.D_P = 10 * MatrixXd::Identity(6, 6) + m.L_P.transpose() * m.L_P;
  MatrixXd locked = random(6, 6);
  locked.bottomRows(2).setZero();
  m.children = {{"C", {1, 0, 0}, locked}, {"D", {1, 1, 0}, random(6, 6)}};
  Diagram d{"locked"};
  auto b = d.add("b", FlexibleBody{m});
  ground(b);
  b.child("C").accel = 0;
  b.child("D").force += d.input("u", 6);
  d.output("a", 6) = b.child("D").accel;
  const System system = compile(d);
  CHECK(system.order() == 4);
  const FullCertificate c = certify(system);
  CHECK(c.exact.decided);
  CHECK(c.exact.order == 4);
  CHECK(c.faults == std::vector<std::string>{});
}

TEST_CASE("chains that numbers close but for the last place are not decided exactly") {
  // Two arms of 0.3 and one of 0.6 between the same hinges: 0.3 + 0.3 is 0.6 up to rounding.
  Diagram d{"triangle"};
  const Beam beam{.length = 0.3,
                  .section = tube(0.04, 0.03),
                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                  .elements = 1};
  auto u = d.input("u", 6);
  auto base = d.add("base", RigidBody{.mass = 1,
                                      .inertia = Eigen::Matrix3d::Identity(),
                                      .children = {{"A", {0, 0, 0}}, {"B", {0.1, 0.2, 0}}}});
  auto tip = d.add("tip", RigidBody{.mass = 1,
                                    .inertia = Eigen::Matrix3d::Identity(),
                                    .children = {{"B", {0.7 - 0.6, 0.2, 0}}}});
  auto a = d.add("a", FlexibleBody{beam}), b = d.add("b", FlexibleBody{beam});
  base.parent.force = -u;
  mount(a, base.child("A")), mount(b, base.child("B"));
  mount(tip, a.child);
  weld(tip.child, b.child);
  d.output("acc", 6) = tip.parent.accel;
  const System system = compile(d);
  CHECK(system.order() == 12);
  const ExactOrder exact = exact_order(d.graph());
  CHECK(exact.decided);
  CHECK(exact.order > 12);
  const FullCertificate c = certify(system, {.exact = {.states = 40}});
  CHECK_FALSE(c.exact.decided);
  CAPTURE(c.exact.why_not);
  CHECK(has_names(c.exact.why_not, {fmt::format("{}", exact.order), "12"}));
  CHECK(c.faults == std::vector<std::string>{});
}
