#include <doctest/doctest.h>

#include <titop/graph/linalg/index.hpp>

#include "hub_and_boom.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Slide and joints of several axes against M, D and K assembled by hand, against each other and
/// against partial drives; their refusals.

using namespace joint_test;
using namespace titop;
using titop_test::error_of;
using titop_test::next_line;
using titop_test::says;

namespace {

const Vector3d kR = Vector3d(2, -1, 2) / 3;  // a unit vector

using titop::linalg::at;

MatrixXd columns(std::initializer_list<Vector6> list) {
  MatrixXd S(6, static_cast<Index>(list.size()));
  Index i = 0;
  for (const Vector6& s : list) S.col(i++) = s;
  return S;
}
Vector6 linear(const Vector3d& r) { return (Vector6() << r, 0, 0, 0).finished(); }
Vector6 angular(const Vector3d& r) { return (Vector6() << 0, 0, 0, r).finished(); }
MatrixXd diagonal(std::initializer_list<double> d) {
  return Eigen::Map<const VectorXd>(d.begin(), static_cast<Index>(d.size())).asDiagonal();
}

}  // namespace

TEST_CASE("slide: spring, damper and actuator, against M, D, K") {
  Setup scene;
  auto s = slide(scene.d, "jack", scene.boom, scene.hub.child("C"), mounting(), 5 * kR);
  s.force = 2e4 * s.travel + 30 * s.rate - scene.d.input("u");
  scene.d.output("x") = s.travel;
  const System system = compile(scene.d);
  const auto a = assemble(columns({linear(kR)}), diagonal({2e4}), diagonal({30}));
  const auto exact = exact_transfers(a);
  CHECK(by_hand::transfer_error(responses(system, kPoints), exact) <= 1e-11);
  CHECK(by_hand::transfer_error(responses(system.state_space(), kPoints), exact) <= 1e-9);
  CHECK(system.state_space().order() == 2 * 13);
  CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(elastic(a, 6))) <=
        1e-9);
}

TEST_CASE("slide: driven, its force accelerates the boom; free, it has no unseen states") {
  const auto a = assemble(columns({linear(kR)}), diagonal({0}), diagonal({0}));
  const auto exact = exact_transfers(a);
  {
    Setup scene;
    auto s = slide(scene.d, "jack", scene.boom, scene.hub.child("C"), mounting(), kR);
    s.accel = scene.d.input("xdd");
    scene.d.output("f") = s.force;
    const System system = compile(scene.d);
    std::vector<MatrixXcd> driven;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      // The force on the boom, -f, drives q: exchange input and output of the axis.
      MatrixXcd G = exact[i];
      G.bottomRows(1) *= kPoints[i] * kPoints[i];
      const Complex g = G(12, 12);
      MatrixXcd H = G - G.col(12) * G.row(12) / g;
      H.col(12) = G.col(12) / g;
      H.row(12) = G.row(12) / g;
      H(12, 12) = -1.0 / g;
      driven.push_back(H);
    }
    CHECK(by_hand::transfer_error(responses(system, kPoints), driven) <= 1e-11);
    CHECK(system.state_space().order() == 2 * 12);
  }
  Setup scene;
  auto s = slide(scene.d, "jack", scene.boom, scene.hub.child("C"), mounting(), kR);
  s.force = 0;
  const System system = compile(scene.d);
  const auto all = first(12);
  CHECK(error_3(responses(system, kPoints), part(exact, all, all)) <= 1e-11);
  CHECK(system.state_space().order() == 2 * 12);
}

TEST_CASE("joint: any axes, free, sprung and locked, against M, D, K") {
  struct Case {
    std::vector<Axis> axes;
    MatrixXd S;
  };
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::vector<Case> cases{
      {ball(), columns({angular(x), angular(y), angular(z)})},
      {universal(kR, {0, 3, 0}), columns({angular(kR), angular(y)})},
      {cylindrical(2 * kR), columns({linear(kR), angular(kR)})},
      {{along(x), along({1, 1, 0}), along(z), about(kR)},  // oblique ones too
       columns({linear(x), linear((x + y).normalized()), linear(z), angular(kR)})},
      {{along(x), along(y), along(z), about(x), about(y), about(z)}, MatrixXd::Identity(6, 6)}};
  for (const Case& c : cases) {
    const Index k = c.S.cols();
    CAPTURE(k);
    const VectorXd stiffness = VectorXd::LinSpaced(k, 3e3, 9e3);
    const VectorXd damping = VectorXd::LinSpaced(k, 5, 1);
    for (const bool sprung : {true, false}) {
      if (!sprung && k == 6) continue;  // two separate structures
      Setup scene;
      auto j = joint(scene.d, "j", scene.boom, scene.hub.child("C"), mounting(), c.axes);
      for (Index i = 0; i < k; ++i) {
        const std::string& given = c.axes[at(i)].name;
        auto axis = j.axis(given.empty() ? "axis" + std::to_string(i + 1) : given);
        const std::string n = std::to_string(i);
        if (sprung) axis.force = stiffness(i) * axis.position + damping(i) * axis.rate;
        axis.force -= scene.d.input("u" + n);
        if (sprung) scene.d.output("q" + n) = axis.position;
      }
      const System system = compile(scene.d);
      const double on = sprung ? 1 : 0;
      const auto a =
          assemble(c.S, on * MatrixXd(stiffness.asDiagonal()), on * MatrixXd(damping.asDiagonal()));
      auto exact = exact_transfers(a);
      if (!sprung) exact = part(exact, first(12), first(12 + k));
      std::vector<Index> rows(4, 3), cols(4, 3);  // halves of W, F, P and tip; then one by one
      rows.resize(4 + (sprung ? at(k) : 0), 1);
      cols.resize(4 + at(k), 1);
      CHECK(titop_test::transfer_error(responses(system, kPoints), exact, rows, cols) <= 1e-10);
      CHECK(system.state_space().order() == 2 * (12 + (sprung ? k : 0)));
      const auto poles = by_hand::poles(elastic(a, sprung ? 6 : 6 + k));
      CHECK(by_hand::pole_error(by_hand::moving(system.poles()), poles) <= 1e-9);
    }
  }
}

TEST_CASE("joint: one axis is a hinge or a slide; two are hinges one after the other") {
  const auto with = [](auto hang) {
    Setup scene;
    hang(scene);
    return responses(compile(scene.d), kPoints);
  };
  const auto hinged = with([](Setup& s) {
    auto h = hinge(s.d, "h", s.boom, s.hub.child("C"), mounting(), kR);
    h.torque = 700 * h.angle;
  });
  CHECK(error_3(with([](Setup& s) {
                  auto j = joint(s.d, "j", s.boom, s.hub.child("C"), mounting(), {about(kR, "a")});
                  j.axis("a").force = 700 * j.axis("a").position;
                }),
                hinged) <= 1e-13);
  const auto series = with([](Setup& s) {
    auto outer = s.d.add("outer", Hinge{{0, 1, 0}});
    mount(outer, s.hub.child("C"), mounting());
    auto inner = s.d.add("inner", Hinge{kR});
    mount(inner, outer.child);
    mount(s.boom, inner.child);
    outer.torque = 700 * outer.angle;
    inner.torque = 0;
  });
  CHECK(error_3(with([](Setup& s) {
                  auto j = joint(s.d, "j", s.boom, s.hub.child("C"), mounting(),
                                 universal({0, 1, 0}, kR));
                  j.axis("axis1").force = 700 * j.axis("axis1").position;
                }),
                series) <= 1e-11);
}

TEST_CASE("joint: locked on all its axes it is a mount, driven on one it prescribes it") {
  Setup fixed;
  mount(fixed.boom, fixed.hub.child("C"), mounting());
  Setup locked;
  auto j = joint(locked.d, "j", locked.boom, locked.hub.child("C"), mounting(), ball());
  for (const char* name : {"rx", "ry", "rz"}) j.axis(name).accel = 0;
  CHECK(error_3(responses(compile(locked.d), kPoints), responses(compile(fixed.d), kPoints)) <=
        1e-12);
}

TEST_CASE("pinned beam: one call, the partial drives, and M, K by hand") {
  const auto scene = [](auto hold) {
    Diagram d{"pinned"};
    auto beam = d.add("beam", FlexibleBody{kBoom.beam()});
    hold(d, beam);
    beam.child.force = d.input("F", 6);
    d.output("tip", 6) = beam.child.accel;
    return compile(d);
  };
  const System by_joint = scene([](Diagram& d, BodyHandle& beam) {
    auto base = d.add("base", RigidBody{.children = {{"C"}}});
    ground(base);
    joint(d, "pin", beam, base.child, {}, ball());
  });
  const System by_parts = scene([](Diagram&, BodyHandle& beam) {
    beam.parent.accel.linear = 0;
    release(beam);
  });
  const System by_axes = scene([](Diagram&, BodyHandle& beam) {
    for (int i = 0; i < 3; ++i) ground(beam.parent.along(Vector3d::Unit(i)));
    release(beam);
  });
  const by_hand::Beam beam = kBoom.numbers();
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  const Index n = fe.M.rows() - 3;
  by_hand::Structure a = by_hand::empty(n, 6, 6);
  // Rotations of the root, then displacements relative to it.
  MatrixXd Y = MatrixXd::Zero(fe.M.rows(), n);
  Y.leftCols(3) = by_hand::rigid_motion(beam).rightCols(3);
  Y.bottomRightCorner(n - 3, n - 3).setIdentity();
  a.M = Y.transpose() * fe.M * Y;
  a.K.bottomRightCorner(n - 3, n - 3) = fe.K.bottomRightCorner(n - 3, n - 3);
  a.C = Y.bottomRows(6);
  a.B = a.C.transpose();
  std::vector<MatrixXcd> exact;
  for (const Complex s : kPoints) exact.push_back(by_hand::accel_transfer(a, s));
  for (const System* system : {&by_joint, &by_parts, &by_axes}) {
    CHECK(error_3(responses(*system, kPoints), exact) <= 1e-11);
    CHECK(system->state_space().order() == 2 * 12);
    CHECK(by_hand::pole_error(by_hand::moving(system->poles()), by_hand::poles(elastic(a, 3))) <=
          1e-9);
  }
  // Hinged at one end, free at the other: the first bending frequency is that of
  // tan(b l) = tanh(b l), b l = 3.926602; two elements of cubic shapes give it to 1 %.
  double first = 0;
  for (const Pole& p : by_joint.poles())
    if (p.omega > 0 && first == 0) first = p.omega;
  const double bl = 3.926602312 / beam.length;
  const double omega = bl * bl * std::sqrt(beam.EI / beam.mass);
  CHECK(titop_test::relative(first, omega) <= 0.01);
}

TEST_CASE("positions go through joints") {
  Diagram d{"reach"};
  auto base = d.add("base", RigidBody{.children = {{"C"}}});
  ground(base);
  auto arm = d.add(
      "arm",
      RigidBody{.mass = 2, .inertia = Matrix3d::Identity(), .children = {{"T", {0.5, 0, 0}}}});
  auto j = joint(d, "j", arm, base.child, {}, cylindrical({0, 0, 1}));
  auto travel = j.axis("travel"), angle = j.axis("angle");
  travel.force = 100 * travel.position;
  angle.force = 50 * angle.position - d.input("u");
  d.output("T", 6) = arm.child.position;
  const MatrixXd G = compile(d).state_space().transfer(0).real();
  // u turns the arm by u / 50; its tip moves by 0.5 m times that along y.
  const VectorXd expected = (VectorXd(6) << 0, 0.5, 0, 0, 0, 1).finished() / 50;
  CHECK((G - expected).cwiseAbs().maxCoeff() <= 1e-15);
}

TEST_CASE("joint: states, ports and errors have the axes' names") {
  Setup scene;
  auto j = joint(scene.d, "gimbal", scene.boom, scene.hub.child("C"), mounting(),
                 {about({1, 0, 0}, "roll"), about({0, 1, 0})});
  for (const char* name : {"roll", "axis2"}) {
    auto axis = j.axis(name);
    axis.force = 100 * axis.position;
  }
  scene.d.output("roll") = j.axis("roll").position;
  const auto names = compile(scene.d).state_space().states;
  for (const char* name : {"gimbal.roll", "gimbal.axis2", "gimbal.roll_rate"})
    CHECK(std::find(names.begin(), names.end(), name) != names.end());
  CHECK(says(error_of([&] { j.axis("yaw"); }), Code::unknown_name,
             {"gimbal", "\"yaw\"", "roll, axis2"}));
  const auto line = next_line();
  j.axis("roll").accel = 0;
  CHECK(says(titop_test::compile_error(scene.d), Code::two_equations, {"gimbal.roll", line}));
}

TEST_CASE("planar: two ways across the normal, right-handed with it, and the turn about it") {
  for (const Vector3d& normal : {Vector3d(0, 0, 2), Vector3d(0, -3, 0), Vector3d(1, -2, 0.5)}) {
    const std::vector<Axis> axes = planar(normal);
    REQUIRE(axes.size() == 3);
    const Vector3d n = normal.normalized(), a = twist(axes[0]).head<3>(),
                   b = twist(axes[1]).head<3>();
    CHECK(axes[0].kind == Axis::Kind::prismatic);
    CHECK(axes[1].kind == Axis::Kind::prismatic);
    CHECK(std::abs(a.dot(n)) <= 1e-15);
    CHECK((a.cross(b) - n).norm() <= 1e-15);
    CHECK((twist(axes[2]) - angular(n)).norm() <= 1e-15);
  }
}

TEST_CASE("joints refuse axes that are none, and a joint by itself must be driven") {
  const auto refused = [](const auto& spec) {
    return error_of([&] {
      Diagram d{"refused"};
      d.add("X", spec);
    });
  };
  CHECK(says(refused(Slide{.axis = {0, 0, 0}}), Code::bad_value, {"X", "axis", "(0, 0, 0)"}));
  CHECK(says(refused(Joint{}), Code::bad_value, {"X", "axis"}));
  CHECK(says(refused(Joint{{about({1, 0, 0}), about({0, 0, 0})}}), Code::bad_value,
             {"X", "axis", "(0, 0, 0)"}));
  CHECK(says(refused(Joint{{about({1, 0, 0}), along({1, 0, 0}), about({0, 1, 0}, "b"),
                            about({1, 1, 0}, "tilt")}}),
             Code::bad_value, {"X", "tilt"}));
  CHECK(says(refused(Joint{{about({1, 0, 0}, "a"), along({1, 0, 0}, "a")}}), Code::duplicate_name,
             {"X", "\"a\""}));
  CHECK(
      says(refused(Joint{{about({1, 0, 0}, "child")}}), Code::duplicate_name, {"X", "\"child\""}));

  Setup scene;
  slide(scene.d, "jack", scene.boom, scene.hub.child("C"), mounting(), kR);
  CHECK(says(titop_test::compile_error(scene.d), Code::no_equation,
             {"jack.force = 0", "jack.accel = 0"}));
}

TEST_CASE("a force along an axis without mass: the travel follows, its acceleration is refused") {
  Diagram d{"massless"};
  auto base = d.add("base", RigidBody{.children = {{"C"}}});
  ground(base);
  auto load = d.add("load", RigidBody{.mass = 0, .inertia = Matrix3d::Zero()});
  auto s = slide(d, "jack", load, base.child, {}, {1, 0, 0});
  s.force = 10 * s.travel - d.input("u");
  d.output("x") = s.travel;
  const System system = compile(d);
  CHECK(system.order() == 0);
  CHECK(titop_test::relative(system.transfer({0.3, 2})(0, 0), std::complex<double>(0.1)) <= 1e-15);
  d.output("a_x") = load.parent.accel.along({1, 0, 0});
  CHECK(says(titop_test::compile_error(d), Code::improper, {"u", "a_x", "2", "jack"}));
}
