#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/units.hpp"
#include "scenes/by_hand.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// Motions that no equation determines and on which no output depends (a massless strut rotates
/// freely about its own axis): set to 0 and noted; refused by name if something depends on them.
/// Reference: M, D, K, or the same scene with that motion held.

using namespace scenes_test;
using namespace titop;
using namespace titop::generate;
using namespace titop_test;

namespace {

const std::vector<Complex> kPoints = {{0.2, 0.3}, {0.1, 1.7}, {0.5, 4}, {0.05, 11}};

constexpr double kStrut = 0.8, kBody = 3;  // of the strut [m], of the body [kg]
const Vector3d kPA(0.1, 0.05, -0.02), kPC(0.3, -0.1, 0.2), kPS(0, 0.4, 0.1);  // in the body
const Vector3d kInertia(0.5, 0.7, 0.9);
const Vector6 kStiffness = (Vector6() << 400, 500, 600, 70, 80, 90).finished();
const Vector6 kDamping = 0.01 * kStiffness;

Matrix3d about(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).matrix();
}

/// Orientation of the struts: from the ground, and the body from them.
struct Turns {
  Vector3d axis{1, 2, -1};
  double foot = 0.7, head = 0.4;
};

enum class Foot { ball, universal };  ///< universal: the strut cannot turn about itself

/// A body on a spring-damper of six axes that is mounted, at its parent point, on a massless strut
/// with a ball joint at both ends. The force U acts on it at C. With `second`, another strut
/// supports it at S; with `halves`, the strut is two halves with a bushing between them.
struct Stand {
  Turns turns = {};
  Foot foot = Foot::ball;
  Units units = {};
  bool second = false, halves = false;
  bool spin = false, turn = false;  ///< outputs that depend on it: acceleration, angle at the foot
  bool twisted = false;             ///< a torque on the strut
  bool as_hung = false;             ///< names sort in the order of mounting

  Diagram diagram() const {
    Diagram d{"strut"};
    const double l = units.length, m = units.mass;
    auto U = d.input("U", 6);
    const Param mu = d.param("mu", 0.0), softer = d.param("softer", 1.0);
    // The second strut is offset from the first as S from P.
    const Vector3d beside = about(turns.axis, turns.foot) * about(turns.axis, turns.head) * kPS;
    auto base = d.add("base", RigidBody{.children = {{"C"}, {"C2", l * beside}}});
    auto body = d.add(as_hung ? "v" : "body",
                      RigidBody{.mass = kBody * m,
                                .inertia = m * l * l * Matrix3d(kInertia.asDiagonal()),
                                .PA = l * kPA,
                                .children = {{"C", l * kPC}, {"S", l * kPS}}});
    auto iso =
        d.add(as_hung ? "w" : "iso", Bushing{.stiffness = axes(kStiffness, {0, 1, -2}, softer),
                                             .damping = axes(kDamping, {0, 1, -1}, softer)});
    ground(base), mount(iso, body.child("C")), ground(iso.child);
    body.child("C").force += U;
    const Rotation out = Rotation::about(turns.axis, turns.foot),
                   in = Rotation::about(turns.axis, turns.head);
    auto strut = d.add("strut", link(halves ? kStrut / 2 : kStrut, mu));
    auto pin = joint(d, "foot", strut, base.child("C"), out, axes_of_foot());
    if (halves) {
      auto middle =
          d.add("middle", Bushing{.stiffness = axes(20 * kStiffness, {0, 1, -2}, softer)});
      auto upper = d.add("upper", link(kStrut / 2, 0));
      mount(middle, strut.child), mount(upper, middle.child);
      joint(d, "head", body, upper.child, in, ball());
    } else {
      joint(d, as_hung ? "u" : "head", body, strut.child, in, ball());
    }
    if (second) {
      auto other = d.add("other", link(kStrut, 0));
      joint(d, "foot2", other, base.child("C2"), out, axes_of_foot());
      auto head = d.add("head2", Joint{ball()});
      mount(head, other.child, in);
      weld(body.child("S"), head.child);
      for (const char* name : {"rx", "ry", "rz"}) head.axis(name).force = 0;
    }
    d.output("a", 6) = body.parent.accel;
    if (!halves) d.output("f") = strut.child.force.along({1, 0, 0});
    if (spin) d.output("spin", 6) = strut.child.accel;
    if (turn) d.output("turn") = pin.axis("rx").position;
    if (twisted) strut.child.force.about({1, 0, 0}) += d.input("w");
    return d;
  }

  /// The same by M, D, K: Z are the motions of P that the struts allow. The force in the strut is
  /// the residual of the body's sum of forces. mu: a point mass in the middle of the strut.
  MatrixXcd exact(Complex s, double mu = 0, double softer = 1) const {
    const Vector3d e = (about(turns.axis, turns.foot) * about(turns.axis, turns.head)).transpose() *
                       about(turns.axis, turns.foot).col(0);
    const Matrix6 at_C = by_hand::tau(-kPC), at_A = by_hand::tau(-kPA);
    Matrix6 inertia = Matrix6::Zero();
    inertia.diagonal() << kBody, kBody, kBody, kInertia;
    Matrix6 M = at_A.transpose() * inertia * at_A;
    M.topLeftCorner(3, 3) += mu / 4 * (Matrix3d::Identity() - e * e.transpose());
    const Matrix6 K = softer * at_C.transpose() * kStiffness.asDiagonal() * at_C, D = 0.01 * K;
    MatrixXd along(6, second ? 2 : 1);  // wrench of the struts on the body at P
    along.col(0) << e, 0, 0, 0;
    if (second) along.col(1) << e, kPS.cross(e);
    const MatrixXd Z = Eigen::FullPivLU<MatrixXd>(along.transpose()).kernel();
    const MatrixXcd full = s * s * M + s * D + K;
    const MatrixXcd B = at_C.transpose().cast<Complex>();
    const MatrixXcd q = (Z.transpose() * full * Z).partialPivLu().solve(Z.transpose() * B);
    const MatrixXcd wrench = along.cast<Complex>().colPivHouseholderQr().solve(full * Z * q - B);
    MatrixXcd G(7, 6);
    G << s * s * Z * q, -wrench.row(0);
    return G;
  }

 private:
  std::vector<Axis> axes_of_foot() const {
    return foot == Foot::ball ? ball() : titop::universal({0, 1, 0}, {0, 0, 1});
  }
  RigidBody link(double length, const Value& mass) const {
    return {.mass = mass,
            .inertia = Matrix3d::Zero(),
            .PA = {units.length * length / 2, 0, 0},
            .children = {{"tip", {units.length * length, 0, 0}}}};
  }
  SixAxes axes(const Vector6& v, Dim dim, const Param& factor) const {
    Dim turning = dim;
    turning.length += 2;
    const auto value = [&](int i) -> Value {
      return v(i) * (i < 3 ? dim : turning).factor(units) * factor;
    };
    return {value(0), value(1), value(2), value(3), value(4), value(5)};
  }
};

/// Lines of the log on motions that nothing determines, taken as 0: those with these names.
int undetermined(const System& system, std::initializer_list<std::string_view> names = {}) {
  int count = 0;
  for (const Note& n : system.notes())
    count += n.kind == Note::Kind::info && n.pass == "reduce" && has_name(n.text, "0") &&
             has_names(n.text, names);
  return count;
}

/// The rotation of the strut about itself.
int strut_spins(const System& system) {
  return undetermined(system, {"rotation", "strut.parent", "x"});
}

/// Factors and dense model against the reference; the smallest digits count. Blocks of three.
template <class Exact>
double error_against(const System& system, Exact exact) {
  std::vector<MatrixXcd> right;
  for (const Complex s : kPoints) right.push_back(exact(s));
  std::vector<Index> rows{3, 3}, cols{3, 3};
  if (right[0].rows() > 6) rows.push_back(1);
  return std::max(transfer_error(responses(system, kPoints), right, rows, cols),
                  transfer_error(responses(system.state_space(), kPoints), right, rows, cols));
}

}  // namespace

TEST_CASE("a massless strut between ball joints: its rotation about itself is nobody's affair") {
  const std::vector<Turns> all = {{{1, 2, -1}, 0.7, 0.4},
                                  {{0, 0, 1}, 0, 0},
                                  {{0, 0, 1}, pi / 2, pi / 2},
                                  {{0, 1, 0}, pi, -pi / 2}};
  for (int i = 0; i < 2 * static_cast<int>(all.size()); ++i) {
    const Turns& turns = all[static_cast<std::size_t>(i / 2)];
    CAPTURE(turns.foot);
    Stand scene{.turns = turns, .as_hung = i % 2 == 1};
    const System system = compile(scene.diagram());
    CHECK(strut_spins(system) == 1);
    CHECK(undetermined(system) == 1);
    CHECK(error_against(system, [&](Complex s) { return scene.exact(s); }) <= 1e-11);
    CHECK(system.order() == 10);
    CHECK(system.certificate().residual <= 1e-13);
    CHECK(system.dense_certificate().dense_error <= 1e-9);
    scene.foot = Foot::universal;
    const System held = compile(scene.diagram());
    CHECK(undetermined(held) == 0);
    CHECK(system.states() == held.states());
    CHECK(error_against(held, [&](Complex s) { return scene.exact(s); }) <= 1e-11);
  }
}

TEST_CASE("the full certificate finds no fault, and apply equals the dense model") {
  const System system = compile(Stand{}.diagram());
  const FullCertificate c = certify(system);
  CAPTURE(to_string(c));
  CHECK(c.holds());
  const StateSpace& m = system.state_space();
  const VectorXd x = VectorXd::LinSpaced(system.order(), -1, 2), u = VectorXd::LinSpaced(6, 1, -3);
  const System::Rates r = system.apply(x, u);
  CHECK((r.xdot - (m.A * x + m.B * u)).norm() <= 1e-13 * r.xdot.norm());
  CHECK((r.y - (m.C * x + m.D * u)).norm() <= 1e-13 * r.y.norm());
}

TEST_CASE("two struts, two rotations; two halves with a bushing between turn as one") {
  const Stand two{.second = true};
  const System system = compile(two.diagram());
  CHECK(strut_spins(system) == 1);
  CHECK(undetermined(system, {"rotation", "other.parent", "x"}) == 1);
  CHECK(undetermined(system) == 2);
  CHECK(error_against(system, [&](Complex s) { return two.exact(s); }) <= 1e-11);
  CHECK(system.order() == 8);
  CHECK(system.certificate().residual <= 1e-13);

  const System halves = compile(Stand{.halves = true}.diagram()),
               held = compile(Stand{.foot = Foot::universal, .halves = true}.diagram());
  CHECK(undetermined(halves) == 1);
  CHECK(halves.order() == held.order());
  CHECK(error_against(halves, [&](Complex s) { return held.transfer(s); }) <= 1e-10);
}

TEST_CASE("a strut on springs that do not twist: their twist is read by nothing") {
  const auto scene = [](double twist) {
    Diagram d{"springs"};
    auto U = d.input("U", 6);
    auto base = d.add("base", RigidBody{.children = {{"C"}}});
    auto body = d.add(
        "body",
        RigidBody{
            .mass = kBody, .inertia = kInertia.asDiagonal(), .PA = kPA, .children = {{"C", kPC}}});
    auto strut = d.add(
        "strut",
        RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"tip", {kStrut, 0, 0}}}});
    ground(base);
    bushing(d, "low", strut, base.child, Rotation::about({1, 2, -1}, 0.7),
            {.stiffness = {400, 500, 600, twist, 80, 90}, .damping = {0, 0, 0, 0, 1, 1}});
    bushing(d, "high", body, strut.child, {}, {.stiffness = {900, 800, 700, 0, 60, 50}});
    body.child.force = U;
    d.output("a", 6) = body.parent.accel;
    return compile(d);
  };
  const System free = scene(0), held = scene(70);  // held: no torque about it
  CHECK(strut_spins(free) == 1);
  CHECK(undetermined(held) == 0);
  CHECK(error_against(free, [&](Complex s) { return held.transfer(s); }) <= 1e-10);
  // Ten of the body's motion, less its turn about the strut, two of the dampers; held, that turn is
  // a state that nothing reads.
  CHECK(free.order() == 12);
  CHECK(held.order() == 14);
  CHECK(noted(free, Note::Kind::info, "reduce", {"low.rx, low.rx_rate, high.rx, high.rx_rate"}));
  CHECK(free.certificate().residual <= 1e-13);
}

TEST_CASE("update: other values, and a mass on the strut's axis, which turns as freely") {
  const Stand scene;
  const System light = compile(scene.diagram());
  const System heavy = light.update({{"mu", 2.0}, {"softer", 0.5}});
  CHECK(undetermined(heavy) == 1);
  CHECK(heavy.states() == light.states());
  CHECK(error_against(heavy, [&](Complex s) { return scene.exact(s, 2, 0.5); }) <= 1e-11);
  const System again = heavy.update({{"mu", 0.0}, {"softer", 3.0}});
  CHECK(again.states() == light.states());
  CHECK(error_against(again, [&](Complex s) { return scene.exact(s, 0, 3); }) <= 1e-11);
}

TEST_CASE("reading an undetermined motion is refused; a torque on it contradicts") {
  const Error spin = compile_error(Stand{.spin = true}.diagram());
  CHECK(says(spin, Code::improper, {"rotation", "strut.parent", "x", "spin(4)"}));
  CHECK(compile_error(Stand{.foot = Foot::universal, .spin = true}.diagram()).mistakes().empty());
  const Error turn = compile_error(Stand{.turn = true}.diagram());
  CHECK(says(turn, Code::improper, {"rotation", "strut.parent", "x", "foot.rx_rate"}));
  const Error torque = compile_error(Stand{.twisted = true}.diagram());
  CHECK(torque.mistakes().size() == 1);
  CHECK(torque.has(Code::improper));
  CHECK(!has_name(torque.what(), "rotation"));  // no undetermined one
}

TEST_CASE("units of 1e-9 to 1e9 change neither zeros nor refusals") {
  Rng rng(7);
  const Complex s{0.1, 1.7};
  for (int trial = 0; trial < 24; ++trial) {
    Stand scene{.second = trial % 2 == 1};
    const auto exponent = [&] { return std::pow(10.0, rng.below(19) - 9); };
    scene.units.length = exponent(), scene.units.mass = exponent(), scene.units.time = exponent();
    CAPTURE(scene.units.length);
    CAPTURE(scene.units.mass);
    CAPTURE(scene.units.time);
    const System system = compile(scene.diagram(), {.minimize_up_to = 0});
    CHECK(strut_spins(system) == 1);
    CHECK(undetermined(system) == (scene.second ? 2 : 1));
    MatrixXcd G = system.transfer(s / scene.units.time);
    for (Index i = 0; i < 7; ++i)
      for (Index j = 0; j < 6; ++j)
        G(i, j) *= (j < 3 ? kForce : kTorque).factor(scene.units) / (i < 3   ? kAccel
                                                                     : i < 6 ? kAngularAccel
                                                                             : kForce)
                                                                        .factor(scene.units);
    CHECK(transfer_error({G}, std::vector<MatrixXcd>{scene.exact(s)}, {3, 3, 1}, {3, 3}) <= 1e-10);
    scene.spin = true;
    CHECK(says(compile_error(scene.diagram()), Code::improper, {"spin(4)"}));
  }
}

TEST_CASE("a massless block between springs along some axes: other directions are undetermined") {
  // Along r: wall - k1 - block - k2 - mass m under the force u.
  const auto scene = [](int loaded, const Matrix3d& axes, bool read) {
    Diagram d{"junction"};
    auto N = d.add(
        "N", RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"C", {0, 0, 0}}}});
    release(N);
    for (int i = 0; i < loaded; ++i) {
      auto wall = d.add(fmt::format("wall{}", i), SpringMass{.mass = 1, .stiffness = 30.0 + i}),
           z = d.add(fmt::format("z{}", i), SpringMass{.mass = 2, .stiffness = 50, .damping = 0.2});
      wall.child.accel = 0;
      mount(wall, N.child.along(axes.col(i)));
      mount(z, N.child.along(axes.col(i)));
      z.child.force = d.input(fmt::format("u{}", i));
      d.output(fmt::format("a{}", i)) = z.child.accel;
    }
    if (read) d.output("N", 6) = N.parent.accel;
    return d;
  };
  for (const Matrix3d& axes : {Matrix3d(Matrix3d::Identity()), about({1, -2, 3}, 0.9)})
    for (const int loaded : {1, 2, 3}) {
      CAPTURE(loaded);
      const System system = compile(scene(loaded, axes, false));
      CHECK(undetermined(system, {"rotation", "N.parent"}) == 1);  // about all axes
      CHECK(undetermined(system, {"rotation", "N.parent", "x"}) == 0);
      CHECK(undetermined(system, {"translation", "N.parent"}) == (loaded < 3 ? 1 : 0));
      std::vector<MatrixXcd> exact, factored = responses(system, kPoints),
                                    dense = responses(system.state_space(), kPoints);
      for (const Complex s : kPoints) {
        MatrixXcd G = MatrixXcd::Zero(loaded, loaded);
        for (int i = 0; i < loaded; ++i) {
          const Complex k1 = 30.0 + i, k2 = 50.0 + 0.2 * s;
          G(i, i) = s * s / (2.0 * s * s + k1 * k2 / (k1 + k2));
        }
        exact.push_back(G);
      }
      CHECK(by_hand::transfer_error(factored, exact) <= 1e-12);
      CHECK(by_hand::transfer_error(dense, exact) <= 1e-11);
      CHECK(system.order() == 3 * loaded);  // one state for a damper on a point without mass
      CHECK(system.certificate().residual <= 1e-13);
    }
  const Matrix3d axes = Matrix3d::Identity();
  CHECK(says(compile_error(scene(3, axes, true)), Code::improper, {"rotation", "N.parent", "N("}));
}

TEST_CASE("an arm without mass on a free hinge: the hub moves as if alone") {
  const auto scene = [](bool read) {
    Diagram d{"arm"};
    auto U = d.input("U", 6);
    auto hub = d.add("hub", RigidBody{.mass = 4,
                                      .inertia = Matrix3d(kInertia.asDiagonal()),
                                      .children = {{"C", {1, 0, 0}}}});
    auto arm = d.add(
        "arm", RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"tip", {0, 2, 0}}}});
    hub.parent.force = -U;
    hinge(d, "h", arm, hub.child, Rotation::about({1, 1, 0}, 0.3), {0, 0, 1}).torque = 0;
    d.output("a", 6) = hub.parent.accel;
    if (read) d.output("tip", 6) = arm.child.accel;
    return d;
  };
  const System system = compile(scene(false));
  CHECK(system.order() == 0);
  MatrixXcd exact = MatrixXcd::Zero(6, 6);  // F_P = -D_P a_P, and F_P = -U
  exact.diagonal() << 0.25, 0.25, 0.25, kInertia.cwiseInverse().cast<Complex>();
  CHECK((system.transfer({0.1, 2}) - exact).cwiseAbs().maxCoeff() <= 1e-15);
  CHECK(undetermined(system, {"rotation", "arm.parent", "z"}) == 1);
  CHECK(says(compile_error(scene(true)), Code::improper,
             {"rotation", "arm.parent", "z", "tip(1), tip(6)", "h"}));
}
