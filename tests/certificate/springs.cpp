#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/names.hpp"

/// Springs and dampers that equations make of positions and rates belong to a structure, if they
/// are such: expected asymmetries are written down from masses and springs.

using namespace titop;
using Complex = std::complex<double>;
using Eigen::Matrix2d;
using titop_test::has_names;
using titop_test::relative;

namespace {

/// Masses 1 and 2 on springs 4 and 18 of their own. Forces -K x - C xd on them by equations, in
/// units of length of their own: positions of the second one count as `unit` metres.
Diagram tied(const Matrix2d& K, const Matrix2d& C, double unit) {
  Diagram d{"tied"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 2 * unit * unit, .stiffness = 18 * unit * unit});
  ground(a);
  ground(b);
  const auto x = a.child, y = b.child;
  x.force = d.input("f") - K(0, 0) * x.position - unit * K(0, 1) * y.position - C(0, 0) * x.rate -
            unit * C(0, 1) * y.rate;
  y.force = d.input("g") - unit * K(1, 0) * x.position - unit * unit * K(1, 1) * y.position -
            unit * C(1, 0) * x.rate - unit * unit * C(1, 1) * y.rate;
  d.output("x") = x.accel;
  d.output("y") = y.accel;
  return d;
}

/// |G21 - G12| over the largest of sqrt(|G11 G22|), |G12| and |G21|.
double by_hand(const Matrix2d& K, const Matrix2d& C, Complex s) {
  Eigen::Matrix2cd Z = K.cast<Complex>() + s * C;
  Z(0, 0) += s * s + 4.0;
  Z(1, 1) += 2.0 * s * s + 18.0;
  const Eigen::Matrix2cd G = Z.inverse();
  return std::abs(G(1, 0) - G(0, 1)) /
         std::max({std::sqrt(std::abs(G(0, 0) * G(1, 1))), std::abs(G(0, 1)), std::abs(G(1, 0))});
}

Matrix2d two(double a, double b, double c, double d) {
  Matrix2d m;
  m << a, b, c, d;
  return m;
}

/// A free hub with two panels on hinges, their springs and dampers as equations; attitude control
/// of the hub by wheels. `watched`: a filter reads the left hinge's angle.
Diagram satellite(double k, double c, double kp, double kd, bool watched = false) {
  Diagram d{"satellite"};
  auto hub = d.add("hub", RigidBody{.mass = 80,
                                    .inertia = Vector3d(9, 8, 7).asDiagonal(),
                                    .PA = {0.1, 0.2, 0},
                                    .children = {{"L", {0, 1, 0}}, {"R", {0, -1, 0.2}}}});
  auto torque = d.input("torque", 3);
  hub.parent.force.linear = 0;
  hub.parent.force.angular =
      kp * hub.parent.position.angular() + kd * hub.parent.rate.angular() - torque;
  for (const char* side : {"L", "R"}) {
    auto panel = d.add(std::string("panel ") + side,
                       FlexibleBody{Beam{.length = 2,
                                         .section = rectangle(0.5, 0.02),
                                         .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                         .elements = 1,
                                         .modes = {.kept = 3}}});
    auto h = hinge(d, std::string("hinge ") + side, panel, hub.child(side),
                   Rotation::about({1, 0, 2}, *side == 'L' ? 1.4 : -1.7), {0, 1, 0});
    h.torque = k * h.angle + c * h.rate;
    if (watched && *side == 'L') {
      auto filter = d.add("filter", Lti{.A = Eigen::MatrixXd{{-3}},
                                        .B = Eigen::MatrixXd{{1}},
                                        .C = Eigen::MatrixXd{{2}},
                                        .D = Eigen::MatrixXd{{0}}});
      filter.in = h.angle;
      d.output("filtered") = filter.out;
    }
    panel.child.force += d.input(std::string("F ") + side, 6);
    d.output(std::string("a ") + side, 6) = panel.child.accel;
  }
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

/// A mass of 2 kg with a force at a point, and one by a one-way port.
struct PushedMass {
  struct Handle {
    Handle(Graph* graph, int node)
        : at(detail::channel<1>(graph, node, 0)),
          push(detail::SignalRef(graph, detail::port_signal(*graph, node, "push"))) {}
    DualPort<1> at;
    Port<0, Kind::plain> push;
  };
};

class PushedMassBlock : public Block {
 public:
  PushedMassBlock() {
    face_.channels = {{"at", 1, Takes::force}};
    face_.inputs = {{"push", 1}};
    matrices_->A.resize(0, 0);
    matrices_->B.resize(0, 2);
    matrices_->C.resize(1, 0);
    matrices_->D = Eigen::MatrixXd{{0.5, 0.5}};
  }
  std::string_view type() const override { return "PushedMass"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }

 private:
  Interface face_;
  std::shared_ptr<Dynamics> matrices_ = std::make_shared<Dynamics>();
};

BlockPtr as_block(const PushedMass&) { return std::make_shared<PushedMassBlock>(); }

}  // namespace

TEST_CASE("forces by positions and rates: symmetric and semidefinite are those of springs") {
  const Matrix2d none = Matrix2d::Zero(), spring = two(30, -30, -30, 30), far = two(5, 2, 2, 9);
  for (const double unit : {1.0, 1e-7, 1e5})
    for (const auto& [K, C] : {std::pair(spring, none), {none, 0.1 * spring}, {far, 0.02 * far}}) {
      CAPTURE(unit);
      const FullCertificate c = certify(compile(tied(K, C, unit)));
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(c.passivity.structure);
      CHECK(c.passivity.least >= -1e-9);
      CHECK(c.reciprocity.structure);
      CHECK(c.reciprocity.asymmetry <= 1e-12);
    }
}

TEST_CASE("others are not: by name, as asymmetric as by hand, and no fault") {
  const Matrix2d none = Matrix2d::Zero();
  struct Case {
    Matrix2d K, C;
    const char *force, *follows;
  };
  for (const double unit : {1.0, 1e-7, 1e5})
    for (const Case& t : {Case{two(30, -29, -30, 30), none, "a.child.force", "positions"},
                          Case{two(30, -30, -30, 29), none, "a.child.force", "positions"},
                          Case{two(0, 0, 0, -0.5), none, "b.child.force", "positions"},
                          Case{two(0, 0, 1, 0), none, "b.child.force", "positions"},
                          Case{none, two(0.1, 0, 0, -0.1), "b.child.force", "rates"},
                          Case{none, two(0.1, 1.3, 0, 2), "a.child.force", "rates"}}) {
      CAPTURE(unit);
      CAPTURE(t.force);
      CAPTURE(t.follows);
      const FullCertificate c = certify(compile(tied(t.K, t.C, unit)));
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(!c.passivity.structure);
      CHECK(!c.reciprocity.structure);
      CHECK(has_names(c.reciprocity.why_no_structure, {t.force, t.follows}));
      if (t.K == t.K.transpose() && t.C == t.C.transpose())
        CHECK(c.reciprocity.asymmetry <= 1e-12);
      else
        CHECK(relative(c.reciprocity.asymmetry, by_hand(t.K, t.C, c.reciprocity.where)) <= 1e-9);
    }
}

TEST_CASE("an antisymmetric part of dampers is gyroscopic: reciprocal with its sign changed") {
  for (const double unit : {1.0, 1e-7, 1e5})
    for (const Matrix2d& C : {two(0.1, 0.3, 0, 2), two(0, 4, -4, 0)}) {
      CAPTURE(unit);
      const FullCertificate c = certify(compile(tied(Matrix2d::Zero(), C, unit)));
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(c.passivity.structure);
      CHECK(c.passivity.least >= -1e-12);
      CHECK(c.reciprocity.structure);
      CHECK(c.reciprocity.reversed);
      CHECK(c.reciprocity.asymmetry <= 1e-12);
    }
}

TEST_CASE("sprung hinges and control of the attitude where it is measured: a structure") {
  const FullCertificate c = certify(compile(satellite(40, 0.3, 100, 60)), {.points = 12});
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(c.reciprocity.structure);
  CHECK(c.reciprocity.forces == 3 + 6 + 6);
  CHECK(c.reciprocity.asymmetry <= 1e-11);
  CHECK(c.passivity.least >= -1e-9);
  const auto why = [](const Diagram& d) {
    return certify(compile(d), {.points = 2}).reciprocity.why_no_structure;
  };
  CHECK(has_names(why(satellite(-1, 0, 100, 60)), {"hinge L.torque", "positions"}));
  CHECK(has_names(why(satellite(1, -0.1, 100, 60)), {"hinge L.torque", "rates"}));
  CHECK(has_names(why(satellite(1, 0, -1, 60)), {"hub.parent.force", "positions"}));
}

TEST_CASE("a spring of six axes between two bodies in frames of any kind") {
  // K on the difference of two points in the frame of one of them, as wrenches on both.
  const auto tied_by = [](const Matrix6& K, const Matrix6& back, const Rotation& T) {
    Diagram d{"tied by equations"};
    auto a = d.add("a", RigidBody{.mass = 5, .children = {{"p", {1, 0.5, 0}}}});
    auto b = d.add("b", RigidBody{.mass = 3, .PA = {0.2, 0, 0.3}, .children = {{"q"}}});
    release(a), release(b);
    const auto p = a.child("p"), q = b.child("q");
    const Rotation to_a = T.named("a", "b");
    p.force = d.input("F", 6) - K * p.position + K * (to_a * q.position);
    q.force = d.input("G", 6) - to_a.inverse() * (back * (to_a * q.position - p.position));
    d.output("p", 6) = p.accel;
    d.output("q", 6) = q.accel;
    return certify(compile(d), {.points = 6});
  };
  const Vector6 axes[] = {(Vector6() << 3e4, 2e4, 1e4, 300, 200, 100).finished(),
                          (Vector6() << 0, 2e4, 0, 300, 0, 0).finished()};
  for (const Vector6& k : axes)
    for (const Rotation& T :
         {Rotation::about({0, 0, 1}, std::numbers::pi / 2), Rotation::about({1, 2, -1}, 0.7)}) {
      Matrix6 R = Matrix6::Zero();
      R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = T.nominal();
      const Matrix6 K = R * k.asDiagonal() * R.transpose();
      const FullCertificate c = tied_by(K, K, T);
      CAPTURE(to_string(c));
      CHECK(c.holds());
      CHECK(c.reciprocity.structure);
      CHECK(c.reciprocity.asymmetry <= 1e-11);
      CHECK(!tied_by(K, 1.001 * K, T).reciprocity.structure);
    }
}

TEST_CASE("blocks that only read a structure do not change it") {
  const System system = compile(satellite(40, 0.3, 100, 60, true));
  const FullCertificate c = certify(system, {.points = 4});
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(c.reciprocity.structure);
  CHECK(c.reciprocity.forces == 3 + 6 + 6);
  // It does read: the last output follows the first force.
  CHECK(std::abs(system.transfer({0, 1})(std::ssize(system.outputs()) - 1, 0)) > 0);
}

TEST_CASE("a body that a one-way port pushes is no structure, and the port is named") {
  Diagram d{"pushed"};
  auto body = d.add("body", PushedMass{});
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  body.at.force = d.input("f");
  body.push = d.input("p");
  z.child.force = d.input("g");
  d.output("a") = body.at.accel;
  d.output("z") = z.child.accel;
  const FullCertificate c = certify(compile(d), {.points = 2});
  CHECK(c.holds());
  CHECK(!c.passivity.structure);
  CHECK(has_names(c.reciprocity.why_no_structure, {"body.push"}));
}
