#include <doctest/doctest.h>

#include <complex>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// A mode that moves the point where a chain closes only by rounding of its shape there.

using namespace titop;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A leg that moves its end C in x and y, and with `noise` in z by a third mode, which moves D.
FlexibleBody leg(int number, double noise, bool turns) {
  const int n = number == 0 ? 2 : 3;
  ModalData m;
  m.omega = VectorXd(n);
  m.omega(0) = 10 + number, m.omega(1) = 20 + number;
  m.xi = VectorXd::Zero(n);
  m.L_P = MatrixXd::Zero(n, 6);
  m.D_P = MatrixXd::Zero(6, 6);
  m.D_P.diagonal() << 4, 4, 4, 1, 1, 1;
  MatrixXd C = MatrixXd::Zero(6, n), D = C;
  C(0, 0) = 0.5, C(1, 1) = 0.4;
  if (turns) C(4, 0) = 0.3, C(3, 1) = 0.2;
  if (n == 3) {
    m.omega(2) = 5;
    m.L_P(2, 2) = 0.3;
    C(2, 2) = noise, D(2, 2) = 1;
    if (turns) C(3, 2) = noise;
  }
  m.children.push_back({"C", {0, 0, 0}, C});
  if (n == 3) m.children.push_back({"D", {0, 0, 1}, D});
  return FlexibleBody{m};
}

}  // namespace

TEST_CASE("loops: rounding at a node of its shape does not hold a mode") {
  for (const bool turns : {false, true})
    for (const double noise : {0.0, 1e-17, 1e-14, 1e-10}) {
      CAPTURE(turns);
      CAPTURE(noise);
      Diagram d{"plate on two legs"};
      auto base = d.add("base", RigidBody{.children = {{"C0"}, {"C1"}}});
      auto top = d.add(
          "top",
          RigidBody{.mass = 3, .inertia = Eigen::Matrix3d::Identity(), .children = {{"other"}}});
      ground(base);
      std::vector<FlexibleBody::Handle> legs;
      for (int i = 0; i < 2; ++i) {
        legs.push_back(d.add("leg" + std::to_string(i), leg(i, noise, turns)));
        mount(legs.back(), base.child("C" + std::to_string(i)));
      }
      mount(top, legs[0].child("C"));
      weld(legs[1].child("C"), top.child("other"));
      legs[1].child("D").force += d.input("F", 6);
      d.output("a", 6) = legs[1].child("D").accel;
      const System s = compile(d);
      CHECK(s.order() == 6);
      // D depends on the third mode alone: s^2 / (s^2 + 25).
      CHECK(std::abs(s.transfer(0.7)(2, 2) / (0.49 / 25.49) - 1.0) <= 1e-9);
    }
}
