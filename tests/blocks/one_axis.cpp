#include <doctest/doctest.h>

#include "hub_and_boom.hpp"
#include "support/mistakes.hpp"

/// Blocks of one axis on a point with six: along r and about r.

using namespace joint_test;
using namespace titop;
using titop_test::says;

namespace {

const Vector3d kR = Vector3d(1, 2, 2) / 3;

/// A free rigid hub with masses m_i on springs at C: along or about r_i, row s_i' tau_CP.
struct Hung {
  Vector6 s;
  double m, k, c;
};
by_hand::Structure by_hand_hub(const std::vector<Hung>& list) {
  const auto k = static_cast<Index>(list.size());
  by_hand::Structure a = by_hand::empty(6 + k, 6, 6 + k);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(kMass);
  a.M.block(3, 3, 3, 3).diagonal() = kInertia;
  for (Index i = 0; i < k; ++i) {
    const Hung& h = list[static_cast<std::size_t>(i)];
    MatrixXd motion = MatrixXd::Zero(1, 6 + k);
    motion.leftCols(6) = h.s.transpose() * by_hand::tau(-kPC);
    motion(0, 6 + i) = 1;
    a.M += h.m * motion.transpose() * motion;
    a.K(6 + i, 6 + i) = h.k;
    a.D(6 + i, 6 + i) = h.c;
    a.C(6 + i, 6 + i) = 1;
  }
  a.C.topLeftCorner(6, 6).setIdentity();
  a.B.topRows(6).setIdentity();
  return a;
}

}  // namespace

TEST_CASE("spring-masses along and about axes of a body's point") {
  Diagram d{"sloshing"};
  auto W = d.input("W", 6);
  auto h = d.add("hub", hub());
  h.parent.force = -W;
  auto slosh = d.add("slosh", SpringMass{.mass = 6, .stiffness = 90, .damping = 0.4});
  auto wheel = d.add("wheel", SpringMass{.mass = 0.3, .stiffness = 20, .damping = 0.1});
  mount(slosh, h.child("C").along(4 * kR));
  mount(wheel, h.child.about({0, 0, 2}));
  d.output("P", 6) = h.parent.accel;
  d.output("x") = slosh.stretch;
  d.output("angle") = wheel.stretch;
  const System system = compile(d);
  Vector6 along = Vector6::Zero(), about = Vector6::Zero();
  along.head<3>() = kR;
  about(5) = 1;
  const auto a = by_hand_hub({{along, 6, 90, 0.4}, {about, 0.3, 20, 0.1}});
  std::vector<MatrixXcd> exact;
  const auto s = points({0.5, 3, 6, 12, 80, 900});
  for (const Complex z : s) {
    exact.push_back(by_hand::accel_transfer(a, z));
    exact.back().bottomRows(2) /= z * z;
  }
  CHECK(by_hand::transfer_error(responses(system, s), exact) <= 1e-12);
  CHECK(system.state_space().order() == 4);
  CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(elastic(a, 6))) <=
        1e-10);
}

TEST_CASE("one axis of a held point is a position too, and its reaction a force") {
  Diagram d{"held"};
  auto base =
      d.add("base",
            RigidBody{.mass = 1, .inertia = Matrix3d::Identity(), .children = {{"C", {0, 0, 1}}}});
  ground(base);
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  mount(z, base.child("C").along({0, 3, 0}));
  z.child.force = d.input("f");
  d.output("x") = z.position;
  d.output("on C") = base.child("C").along({0, 1, 0}).force;
  d.output("on P") = base.parent.about({1, 0, 0}).reaction;
  const MatrixXd G = compile(d).state_space().transfer(0).real();
  CHECK(std::abs(G(0) - 1.0 / 8) <= 1e-15);
  CHECK(std::abs(G(1) - 1) <= 1e-15);
  CHECK(std::abs(G(2) + 1) <= 1e-15);  // y-force 1 m above P: torque -1 about x
}

TEST_CASE("along and about belong to six degrees of freedom; no direction is refused") {
  Diagram d{"wrong"};
  auto h = d.add("hub", hub());
  CHECK(says(titop_test::error_of([&] {
               h.child.about({0, 0, 0});
             }),
             Code::bad_value, {"hub.child(\"C\").accel.angular.along(0, 0, 0)"}));
  h.parent.force = 0;
  auto z = d.add("z", SpringMass{});
  const auto line = titop_test::next_line();
  mount(z, h.child("no such").along({1, 0, 0}));
  CHECK(says(titop_test::compile_error(d), Code::unknown_name, {"hub", "\"no such\"", line}));
}
