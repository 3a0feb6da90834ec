#include <doctest/doctest.h>

#include <functional>

#include "lft/n17.hpp"
#include "support/mistakes.hpp"

/// Parameters and ranges that cannot be isolated: each is refused by name.

using namespace lft_test;
using titop_test::error_of;
using titop_test::says;

namespace {

Error lft_error(const System& system, const ParameterRanges& ranges) {
  return error_of([&] { lft(system, ranges); });
}

/// A block of one gain, which says nothing about its parameter.
struct Closed {
  Value gain = 1;
  using Handle = Gain::Handle;
};

class ClosedBlock : public Block {
 public:
  explicit ClosedBlock(Value gain) : gain_(gain) {
    face_.inputs = {{"in", 1}};
    face_.outputs = {{"out", 1}};
  }
  std::string_view type() const override { return "Closed"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    auto d = std::make_shared<Dynamics>();
    d->A.resize(0, 0), d->B.resize(0, 1), d->C.resize(1, 0);
    d->D = Eigen::MatrixXd::Constant(1, 1, std::exp(gain_.at(values)));
    return d;
  }
  std::vector<Value> values() const override { return {gain_}; }

 private:
  Interface face_;
  Value gain_;
};

BlockPtr as_block(const Closed& spec) { return std::make_shared<ClosedBlock>(spec.gain); }

/// A spring of stiffness k on the ground, whose mass is pushed back by a times its acceleration.
System spring() {
  Diagram d{"spring"};
  const Param k = d.param("k", 4), a = d.param("a", 0.5);
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = k});
  ground(z);
  z.child.force = d.input("u") - a * z.child.accel;
  d.output("x") = z.stretch;
  return compile(d);
}

}  // namespace

TEST_CASE("names and ranges are refused together, each with its numbers") {
  const System system = compile(Satellite{}.diagram());
  const Error e = lft_error(system, {{"m", between(1200, 1500)},
                                     {"mass", percent(10)},
                                     {"w", full_turn()},
                                     {"tilt", between(-3, 3)},
                                     {"x", percent(10)},
                                     {"x", percent(20)}});
  CHECK(e.mistakes().size() == 5);
  CHECK(says(e, Code::bad_value, {"m", "1000", "1200", "1500"}));
  CHECK(says(e, Code::unknown_name, {"mass", "m, tilt, w, x"}));
  CHECK(says(e, Code::bad_value, {"w", "full_turn"}));
  CHECK(says(e, Code::bad_value, {"tilt", "0.4", "full_turn"}));
  CHECK(says(e, Code::duplicate_name, {"x"}));
}

TEST_CASE("a range whose end makes no block") {
  CHECK(says(lft_error(spring(), {{"k", between(-1, 5)}}), Code::bad_value, {"k", "-1", "z"}));
}

TEST_CASE("ranges of two parameters whose ends are fine one by one and make no block together") {
  // I = [4 xy xz; xy 5 0; xz 0 6] belongs to a mass distribution if tr(I)/2 - I is positive: its
  // determinant is 13.125 - 1.5 xy^2 - 2.5 xz^2, for one of them 2 at least 3, for both -2.9.
  Diagram d{"inertia"};
  const Param xy = d.param("xy", 0.1), xz = d.param("xz", 0.2), m = d.param("m", 9);
  auto body = d.add("body", RigidBody{.mass = m, .inertia = {4, 5, 6, xy, xz, 0}});
  body.parent.force = -d.input("U", 6);
  d.output("y", 6) = body.parent.accel;
  const System system = compile(d);
  const auto up_to = [](double most) { return between(-most, most); };
  CHECK_NOTHROW(lft(system, {{"xy", up_to(2)}, {"m", percent(10)}}));
  CHECK_NOTHROW(lft(system, {{"xz", up_to(2)}, {"m", percent(10)}}));
  const Error e = lft_error(system, {{"xy", up_to(2)}, {"m", percent(10)}, {"xz", up_to(2)}});
  CHECK(says(e, Code::bad_value, {"xy = ", "xz = ", "body", "m = ", "triangle"}));
}

TEST_CASE("a corner at which the direct terms are singular, though no end of a range is") {
  Diagram d{"spring"};
  const Param a = d.param("a", 0.5), b = d.param("b", 0.25);
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 4});
  ground(z);  // (2 + a + b) xdd = u - 4 x: singular at a = b = -1
  z.child.force = d.input("u") - a * z.child.accel - b * z.child.accel;
  d.output("x") = z.stretch;
  CHECK(says(lft_error(compile(d), {{"a", between(-1, 2)}, {"b", between(-1, 2)}}), Code::ill_posed,
             {"a = -1", "b = -1"}));
}

TEST_CASE("a range in which the direct terms are singular, though at no end") {
  // (2 + a) xdd = u - k x: singular at a = -2
  CHECK(says(lft_error(spring(), {{"a", between(-2.5, 1)}}), Code::ill_posed, {"a = -2.5"}));
  CHECK_NOTHROW(lft(spring(), {{"a", between(-1.99, 1)}}));
  // At two places alike: the determinant has no other sign beyond.
  Diagram twice{"twice"};
  const Param both = twice.param("a", 0.5);
  for (const char* name : {"1", "2"}) {
    const std::string number = name;
    auto z = twice.add("z" + number, SpringMass{.mass = 2, .stiffness = 4});
    ground(z);
    z.child.force = twice.input("u" + number) - both * z.child.accel;
    twice.output("x" + number) = z.stretch;
  }
  CHECK(says(lft_error(compile(twice), {{"a", between(-2.5, 1)}}), Code::ill_posed, {"a = -2.5"}));
  // The difference 1.1 - 11 * 0.1 is rounding alone: with one occurrence, too.
  Diagram d{"rounded"};
  const Param a = d.param("a", 0.01);
  auto z = d.add("z", SpringMass{.mass = 1.1, .stiffness = 4});
  ground(z);
  z.child.force = d.input("u") - 11 * a * z.child.accel;
  d.output("x") = z.stretch;
  CHECK(says(lft_error(compile(d), {{"a", between(-0.1, 0.1)}}), Code::ill_posed, {"a = -0.1"}));
}

TEST_CASE("a tilted array on a space station is as well posed as on a small satellite") {
  // Accelerations per newton and newtons per acceleration differ by 1e12: units decide nothing.
  for (const double size : {1.0, 1e5}) {
    CAPTURE(size);
    Diagram d{"station"};
    const Param tilt = d.param("tilt", 0.3);
    auto b = d.add("hub", RigidBody{.mass = 4 * size,
                                    .inertia = Vector3d(40, 40, 60).asDiagonal() * size,
                                    .children = {{"C", {10, 0, 0}}}});
    auto array = d.add("array", RigidBody{.mass = 0.2 * size,
                                          .inertia = Vector3d(10, 12, 20).asDiagonal() * size,
                                          .PA = {10, 0, 0}});
    b.parent.force = -d.input("U", 6);
    mount(array, b.child, Rotation::about({1, 0, 0}, tilt));
    d.output("y", 6) = b.parent.accel;
    const System system = compile(d);
    const Lft f = lft(system, {{"tilt", full_turn()}});
    const Eigen::MatrixXcd G = system.update({{"tilt", 2.5}}).transfer({0.2, 1.7});
    CHECK((f.at({{"tilt", 2.5}}).transfer({0.2, 1.7}) - G).norm() <= 1e-10 * G.norm());
  }
}

TEST_CASE("values outside of a range, and a pole inside") {
  const Lft f = lft(spring(), {{"k", percent(10)}, {"a", between(-1.5, 1)}});
  CHECK(says(error_of([&] { f.at({{"k", 7}}); }), Code::bad_value, {"k", "7", "3.6", "4.4"}));
  CHECK(says(error_of([&] { f.at({{"b", 7}}); }), Code::unknown_name, {"b", "k, a"}));
  CHECK(says(error_of([&] { f.at({{"k", 4}, {"k", 4.1}}); }), Code::duplicate_name, {"k"}));
  // (2 + a) s^2 + k = 0 at s = 2j, a = -1: exactly on the pole
  const std::vector<ParameterList> values{{{"k", 4.1}}, {{"k", 4}, {"a", -1}}};
  const Error both = error_of([&] { f.transfers({0, 2}, values); });
  CHECK(says(both, Code::singular, {"0+2j", "k = 4", "a = -1"}));
  // The same with one occurrence.
  const Lft one = lft(spring(), {{"k", percent(30)}});
  const std::vector<ParameterList> stiff{{{"k", 5}}};  // 2.5 s^2 + 5 = 0
  const Error alone = error_of([&] { one.transfers({0, std::sqrt(2.0)}, stiff); });
  CHECK(says(alone, Code::singular, {"0+1.41421j", "k = 5"}));
}

TEST_CASE("two values at one place of an Lti") {
  Diagram d{"twice"};
  const Param p = d.param("p", 0.5), q = d.param("q", 0.25);
  const auto lti = [&](std::vector<Lti::Entry> values) {
    return Lti{.A = Eigen::Matrix2d{{-1, 2}, {-2, -3}},
               .B = Eigen::Vector2d(1, 0),
               .C = Eigen::RowVector2d(0, 1),
               .values = std::move(values)};
  };
  for (const Value& second : {Value(q), Value(p), Value(3)})
    CHECK(says(error_of([&] {
                 as_block(lti({{'A', 2, 1, p}, {'A', 2, 1, second}}));
               }),
               Code::bad_value, {"A(2, 1)"}));
  CHECK_NOTHROW(as_block(lti({{'A', 2, 1, p}, {'A', 1, 2, q}, {'B', 2, 1, p}})));
}

TEST_CASE("functions of a parameter that are not rational are refused by name") {
  Diagram d{"own"};
  const Param p = d.param("p", 0.5);
  auto u = d.input("u");
  auto c = d.add("c", Closed{p});
  c.in = u;
  d.output("y") = c.out;
  CHECK(says(lft_error(compile(d), {{"p", percent(10)}}), Code::not_rational,
             {"c", "Closed", "p", "sweep"}));

  Diagram e{"both"};
  const Param q = e.param("q", 0.5);
  auto hub = e.add("hub", RigidBody{.children = {{"C", {1, 0, 0}}}});
  auto tip = e.add("tip", RigidBody{.mass = q});
  hub.parent.force = -e.input("U", 6);
  mount(tip, hub.child, Rotation::about({1, 0, 0}, q));
  e.output("y", 6) = hub.parent.accel;
  CHECK(says(lft_error(compile(e), {{"q", between(0.2, 1)}}), Code::not_rational, {"q", "angle"}));
}

TEST_CASE("an angle that moves a closed chain is refused, a mass in it is not") {
  // A four-bar linkage: a rhombus of which two bars turn by the same angle.
  const auto rhombus = [](bool angle) {
    Diagram d{"rhombus"};
    const Param tilt = d.param("tilt", 0.6), m = d.param("m", 2);
    const RigidBody bar{.mass = m,
                        .inertia = Vector3d(0.1, 1, 1).asDiagonal(),
                        .PA = Vector3d(0.5, 0, 0),
                        .children = {{"C", {1, 0, 0}}}};
    const Vector3d up(0, 0, 1);
    const Value turn = angle ? Value(tilt) : Value(0.6);
    auto base = d.add("base", RigidBody{.children = {{"A", {0, 0, 0}}, {"B", {1, 0, 0}}}});
    base.parent.accel = 0;
    auto a = d.add("a", bar), b = d.add("b", bar), c = d.add("c", bar);
    auto ja = hinge(d, "ja", a, base.child("A"), Rotation::about(up, turn), up);
    auto jc = hinge(d, "jc", c, base.child("B"), Rotation::about(up, turn), up);
    auto jb = hinge(d, "jb", b, a.child("C"), Rotation::about(up, -1 * turn), up);
    ja.torque = 3.0 * ja.angle - d.input("u");
    jc.torque = 0, jb.torque = 0;
    auto close = d.add("close", Hinge{up});
    mount(close, b.child("C"));
    close.torque = 0;
    weld(close.child("child"), c.child("C"), Rotation::about(up, -1 * turn));
    d.output("angle") = ja.angle;
    return compile(d);
  };
  CHECK(says(lft_error(rhombus(true), {{"tilt", between(0.4, 0.8)}}), Code::not_rational,
             {"rhombus", "tilt", "sweep"}));
  const System system = rhombus(false);
  const Lft f = lft(system, {{"m", percent(30)}});
  CHECK(f.not_decided() != "");
  const std::complex<double> s{0.1, 0.9};
  const Eigen::MatrixXcd G = system.update({{"m", 2.5}}).transfer(s);
  CHECK((f.at({{"m", 2.5}}).transfer(s) - G).norm() <= 1e-12 * G.norm());
}

namespace {

/// A free hub that carries a rhombus of four bars, on which sits an antenna: the hub carries it
/// tilted by `carried`, the antenna is tilted by `seated`.
System with_linkage(const std::function<Value(const Param&)>& carried,
                    const std::function<Value(const Param&)>& seated) {
  Diagram d{"linkage"};
  const Param p = d.param("p", 0.3);
  const double turn = 0.6;
  const Vector3d up(0, 0, 1);
  const RigidBody bar{.mass = 2,
                      .inertia = Vector3d(0.6, 1, 1.5).asDiagonal(),
                      .PA = Vector3d(0.5, 0.1, 0.2),
                      .children = {{"C", {1, 0, 0}}, {"top", {0.4, 0, 0.3}}}};
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(5, 6, 7).asDiagonal(),
                                    .children = {{"L", {0.5, 0.2, 0.1}}}});
  hub.parent.force = -d.input("U", 6);
  auto base = d.add("base", RigidBody{.children = {{"A", {0, 0, 0}}, {"B", {1, 0, 0}}}});
  mount(base, hub.child, Rotation::about({1, 0, 0}, carried(p)));
  auto a = d.add("a", bar), b = d.add("b", bar), c = d.add("c", bar);
  auto ja = hinge(d, "ja", a, base.child("A"), Rotation::about(up, turn), up);
  auto jc = hinge(d, "jc", c, base.child("B"), Rotation::about(up, turn), up);
  auto jb = hinge(d, "jb", b, a.child("C"), Rotation::about(up, -turn), up);
  ja.torque = 3.0 * ja.angle;
  jc.torque = 0, jb.torque = 0;
  auto close = d.add("close", Hinge{up});
  mount(close, b.child("C"));
  close.torque = 0;
  weld(close.child("child"), c.child("C"), Rotation::about(up, -turn));
  auto antenna = d.add("antenna", RigidBody{.mass = 1, .PA = {0.3, 0, 0.1}});
  mount(antenna, b.child("top"), Rotation::about({0, 1, 0}, seated(p)));
  d.output("angle") = ja.angle;
  d.output("tip", 6) = antenna.parent.accel;
  return compile(d);
}

}  // namespace

TEST_CASE("an angle outside of a closed chain, which it carries or which carries it") {
  const auto fixed = [](const Param&) { return Value(0.2); };
  const auto moves = [](const Param& p) { return Value(p); };
  for (const bool carried : {true, false}) {
    CAPTURE(carried);
    const System system = carried ? with_linkage(moves, fixed) : with_linkage(fixed, moves);
    const Lft f = lft(system, {{"p", between(-1, 1.5)}});
    INFO(to_string(f));
    for (const double p : {-0.9, 0.1, 1.4}) {
      const std::complex<double> s{0.1, 0.9};
      const Eigen::MatrixXcd G = system.update({{"p", p}}).transfer(s, Precision::digits50);
      CHECK((f.at({{"p", p}}).transfer(s) - G).norm() <= 1e-11 * G.norm());
    }
  }
}
