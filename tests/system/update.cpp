#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <titop/titop.hpp>

#include "distance.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// New values on the old plan against a fresh compile of the same numbers.

using namespace titop;
using titop_test::error_of;
using titop_test::matrix_error;
using titop_test::relative;
using titop_test::Rng;
using titop_test::says;

namespace {

struct Numbers {
  double mass = 4.4, angle = 0.3, k = 26.3, gain = 1.3, out = 5.5;
};

FlexibleBody boom() {
  return Beam{.length = 2.0,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 3,
              .modes = {.kept = 6, .xi = {0.005}}};
}

/// Hub, boom at an angle, hinge with a spring, controller gain: a parameter in every place.
Diagram scene(const Numbers& n) {
  Diagram d{"drive"};
  auto U = d.input("U", 6);
  auto B = d.add("B", RigidBody{.mass = d.param("mass", n.mass), .children = {{"C1", {1, 0, 0}}}});
  auto A = d.add("A", boom());
  auto tip = d.add("tip", RigidBody{.mass = 2.0});
  auto g = d.add("g", Gain{.gain = d.param("gain", n.gain)});
  B.parent.force = -U;
  auto h = hinge(d, "h", A, B.child("C1"),
                 Rotation::about({0, 3, 4}, Value(d.param("angle", n.angle))), {0, 0, 1});
  mount(tip, A.child);
  g.in = h.rate;
  h.torque = d.param("k", n.k) * h.angle + g.out;
  d.output("a", 6) = tip.parent.accel;
  d.output("x") = d.param("out", n.out) * h.angle;
  return d;
}

double distance(const System& a, const System& b) {
  StateSpace m, n;
  a.write(m);
  b.write(n);
  return titop_test::distance(m, n);
}

}  // namespace

TEST_CASE("update: the same model as a fresh compile, whatever parameter changes") {
  const System before = compile(scene({}));
  const std::vector<std::pair<ParameterList, Numbers>> cases{
      {{{"mass", 9.0}}, {.mass = 9.0}},
      {{{"angle", -1.2}}, {.angle = -1.2}},
      {{{"k", 3.0}}, {.k = 3.0}},
      {{{"gain", 0.0}}, {.gain = 0.0}},
      {{{"out", -2.0}}, {.out = -2.0}},
      {{{"mass", 1.0}, {"angle", 2.0}, {"k", 1e3}}, {.mass = 1.0, .angle = 2.0, .k = 1e3}}};
  for (const auto& [list, numbers] : cases) {
    CAPTURE(list.front().first);
    const System updated = before.update(list), fresh = compile(scene(numbers));
    CHECK(distance(updated, fresh) <= 1e-14);
    CHECK(updated.states() == fresh.states());
    CHECK(updated.certificate().residual <= 1e-13);
    CHECK(distance(updated, before) >= 1e-7);
    const std::complex<double> s{0.3, 7};
    CHECK(matrix_error(updated.transfer(s), fresh.transfer(s)) <= 1e-13);
  }
}

TEST_CASE("update: there and back is the same to the last bit") {
  const System before = compile(scene({}));
  const System back =
      before.update({{"mass", 9.0}, {"k", 1.0}}).update({{"mass", 4.4}, {"k", 26.3}});
  CHECK(distance(back, before) == 0);
  CHECK(back.parameters() == before.parameters());
}

namespace {

/// Balanced binary tree of springs; the mass of the last leaf is a parameter.
Diagram tree(int levels) {
  Diagram d{"tree"};
  auto u = d.input("u");
  const int n = (1 << levels) - 1;
  std::vector<SpringMass::Handle> z;
  z.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      SpringMass{.mass = i + 1 == n ? Value(d.param("m", 1.0)) : Value(1.0),
                                 .stiffness = 100.0,
                                 .parent_mass = 0.5}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[static_cast<std::size_t>((i - 1) / 2)].child);
  }
  z[0].child.force += u;
  d.output("a") = z.back().child.accel;
  return d;
}

}  // namespace

TEST_CASE("update: one body changed makes only the fronts up to the root again") {
  const System before = compile(tree(9));
  const System after = before.update({{"m", 3.0}});
  CHECK(before.certificate().fronts_made == before.certificate().fronts);
  CHECK(after.certificate().fronts_made >= 1);
  CHECK(after.certificate().fronts_made <= 4 * 9);
  CHECK(after.certificate().fronts >= 500);
  CHECK(before.update({{"m", 1.0}}).certificate().fronts_made == 0);
}

namespace {

/// A chain whose numbers are parameters: of every mass, its share of the parent's side and spring.
Diagram chain(const ParameterList& values) {
  Diagram d{"chain"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(values.size() / 3);
  auto next = [&, i = std::size_t{0}]() mutable {
    const auto& [name, value] = values[i++];
    return d.param(name, value);
  };
  for (std::size_t i = 0; i < values.size() / 3; ++i) {
    const Value mass = next(), parent_mass = next(), stiffness = next();
    z.push_back(
        d.add(fmt::format("z{}", i + 1),
              SpringMass{.mass = mass, .stiffness = stiffness, .parent_mass = parent_mass}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[i - 1].child);
  }
  z.back().child.force = u;
  d.output("first") = z[0].child.accel;
  d.output("last") = z.back().child.accel;
  return d;
}

/// Values of all its parameters, within so many decades of those that one would take.
ParameterList numbers(int bodies, double decades, Rng& random) {
  ParameterList list;
  const auto about = [&](double value) {
    return value * std::pow(10, decades * random.between(-1, 1));
  };
  for (int i = 1; i <= bodies; ++i) {
    list.emplace_back(fmt::format("m{}", i), about(1));
    list.emplace_back(fmt::format("p{}", i), about(0.5));
    list.emplace_back(fmt::format("k{}", i), about(100));
  }
  return list;
}

}  // namespace

TEST_CASE("update: far from the old values it equals a fresh compile, and counts that") {
  Rng random(8);
  for (int round = 0; round < 100; ++round) {
    const ParameterList start = numbers(8, 0, random), far = numbers(8, 12, random);
    const System updated = compile(chain(start)).update(far), fresh = compile(chain(far));
    CHECK(distance(updated, fresh) == 0);
    CHECK(updated.certificate().plans_renewed == 1);
    CHECK(updated.certificate().residual == fresh.certificate().residual);
  }
}

TEST_CASE("update: near the old values the scaling stays, and that is no loss") {
  Rng random(9);
  for (int round = 0; round < 100; ++round) {
    const ParameterList start = numbers(8, 0, random), near = numbers(8, 0.8, random);
    const System updated = compile(chain(start)).update(near), fresh = compile(chain(near));
    CHECK(distance(updated, fresh) <= 1e-13);
    CHECK(updated.certificate().plans_renewed == 0);
    CHECK(updated.certificate().residual <= 1e-13);
  }
}

TEST_CASE("update: steps that are small each, far in all, count from where the scaling was found") {
  const System start = compile(tree(3));
  System system = start;
  for (int i = 1; i <= 12; ++i) system = system.update({{"m", std::pow(4.0, i)}});
  // 4, 16 (anew), 64, 256 (anew), ...
  CHECK(system.certificate().plans_renewed == 6);
  CHECK(distance(system, start.update({{"m", std::pow(4.0, 12)}})) == 0);
}

namespace {

/// y = u / (1 - g), g a parameter, 0.6 at first.
Diagram loop() {
  Diagram d{"loop"};
  const Param g = d.param("g", 0.6);
  auto u = d.input("u");
  auto sum = d.add("sum", Sum{.signs = "++"});
  sum.in(1) = u;
  sum.in(2) = g * sum.out;
  d.output("y") = sum.out;
  return d;
}

}  // namespace

TEST_CASE("update: where pivots lose half their digits all is made anew, and that is counted") {
  // The difference 1 - g: the value changes by less than a factor of 2, the pivot by a thousand
  // million.
  const System before = compile(loop());
  CHECK(before.update({{"g", 0.7}}).certificate().plans_renewed == 0);
  const System after = before.update({{"g", 1 - 1e-10}});
  CHECK(after.certificate().plans_renewed == 1);
  CHECK(relative(after.static_gain()(0, 0), 1e10) <= 1e-5);  // 1 - g is off by 1e-16
}

TEST_CASE("update: digits that go in many small steps are made good as those that go in one") {
  // The pivot 1 - g, of terms 1 + g, falls to a tenth with every step: from 0.4 / 1.6 at g = 0.6 it
  // has lost half its digits if 10^-k / 2 < 1e-8 / 4, from k = 9 on.
  const System start = compile(loop());
  System system = start;
  for (int k = 1; k <= 12; ++k) {
    CAPTURE(k);
    const ParameterList values{{"g", 1 - std::pow(10, -k)}};
    system = system.update(values);
    CHECK(system.certificate().plans_renewed == (k < 9 ? 0 : 1));
    const System at_once = start.update(values);
    CHECK(at_once.certificate().plans_renewed == (k < 9 ? 0 : 1));
    CHECK(system.static_gain()(0, 0) == at_once.static_gain()(0, 0));
  }
  // From there on a loss counts anew: back to where most digits are, and nothing is lost.
  CHECK(system.update({{"g", 0.6}}).certificate().plans_renewed == 1);
}

TEST_CASE("update: the certificate, asked for late, is of the new values and warns of them") {
  // A ring of two signals with gain g around has margin (1 + r) / (1 - r), r = g^(1/2).
  Diagram d{"loop"};
  const Param g = d.param("g", 0.25), other = d.param("other", 1.0);
  auto u = d.input("u");
  auto sum = d.add("sum", Sum{.signs = "++"});
  sum.in(1) = other * u;
  sum.in(2) = g * sum.out;
  d.output("y") = sum.out;
  const System before = compile(d);
  const System after = before.update({{"g", 1 - 1e-9}}).update({{"other", 2.0}});
  CHECK(relative(before.certificate().margin, 3.0) <= 1e-2);
  CHECK(after.certificate().margin >= 1e9);
  const auto warns = [](const System& s) {
    return std::any_of(s.notes().begin(), s.notes().end(),
                       [](const Note& n) { return n.kind == Note::Kind::warning; });
  };
  CHECK(warns(after));
  CHECK(!warns(before));
  CHECK(relative(after.update({{"g", 0.25}}).certificate().margin, 3.0) <= 1e-2);
}

TEST_CASE("update: gains on positions and rates, from and to 0") {
  const auto scene = [](double kp, double kd) {
    Diagram d{"attitude"};
    auto W = d.input("W", 6);
    auto B = d.add("B", RigidBody{.mass = 20, .inertia = Vector3d(3, 4, 5).asDiagonal()});
    B.parent.force = d.param("kp", kp) * B.parent.position + d.param("kd", kd) * B.parent.rate - W;
    d.output("x", 6) = B.parent.position;
    return d;
  };
  const std::complex<double> s{0.4, 1.3};
  for (const auto& [kp, kd] : {std::pair(7.0, 2.0), std::pair(0.0, 2.0), std::pair(7.0, 0.0)}) {
    const System from = compile(scene(kp, kd));
    for (const auto& [p, q] : {std::pair(5.0, 1.0), std::pair(0.0, 3.0), std::pair(6.0, 0.0)}) {
      CAPTURE(kp);
      CAPTURE(kd);
      CAPTURE(p);
      CAPTURE(q);
      const System to = from.update({{"kp", p}, {"kd", q}});
      // One body about its centre of mass: x = W / (m s^2 + kd s + kp), axis by axis.
      const Eigen::VectorXd m = (Eigen::VectorXd(6) << 20, 20, 20, 3, 4, 5).finished();
      Eigen::MatrixXcd exact = Eigen::MatrixXcd::Zero(6, 6);
      for (Eigen::Index i = 0; i < 6; ++i) exact(i, i) = 1.0 / (m(i) * s * s + q * s + p);
      CHECK(matrix_error(to.transfer(s), exact) <= 1e-13);
      CHECK(to.certificate().residual <= 1e-13);
    }
  }
}

TEST_CASE("update: unknown names, values that are none, values that make no block") {
  const System s = compile(scene({}));
  CHECK(says(error_of([&] {
               s.update({{"mas", 1.0}});
             }),
             Code::unknown_name, {"drive", "mas", "mass, gain, angle, k, out"}));
  CHECK(says(error_of([&] { s.update({{"k", std::nan("")}}); }), Code::not_finite, {"k", "nan"}));
  CHECK(says(error_of([&] { s.update({{"mass", -1.0}}); }), Code::bad_inertia, {"B", "-1"}));
  CHECK(error_of([&] { s.update({{"a", 1.0}, {"b", 2.0}}); }).mistakes().size() == 2);
  CHECK(says(error_of([&] { compile(tree(2)).update({{"K", 1.0}}); }), Code::unknown_name, {"m"}));
}
