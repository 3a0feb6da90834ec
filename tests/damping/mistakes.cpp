// Parts that are no structure of modes, and damping that is none.
#include "support/mistakes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <titop/titop.hpp>

using namespace titop;
using namespace titop_test;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Two rigid bodies on a hinge with this torque.
struct OnHinge {
  Diagram d{"wing"};
  BodyHandle root =
      d.add("root",
            RigidBody{.mass = 2, .inertia = Matrix3d::Identity(), .children = {{"C", {1, 0, 0}}}});
  BodyHandle panel = d.add("panel", RigidBody{.mass = 3,
                                              .inertia = Matrix3d::Identity(),
                                              .PA = {0.5, 0, 0},
                                              .children = {{"C", {1, 0, 0}}}});
  Hinge::Handle h = hinge(d, "h", panel, root.child("C"), {}, {0, 0, 1});

  Error made(const std::string& at = "root.parent", const std::string& port = "panel.C") const {
    return error_of([&] { damping_of_assembly(d, at, {{"C", port}}, 0.003); });
  }
};

}  // namespace

TEST_CASE("damping ratios and tables out of range") {
  const auto refused = [](const std::vector<DampingPoint>& table) {
    return error_of([&] { ModalDamping{table}; });
  };
  CHECK(says(error_of([] { ModalDamping{-0.1}; }), Code::bad_value, {"-0.1"}));
  CHECK(says(error_of([] { ModalDamping{kNaN}; }), Code::bad_value, {"nan"}));
  CHECK(says(error_of([] { ModalDamping{1.5}; }), Code::bad_value, {"1.5"}));
  CHECK(says(refused({}), Code::bad_value, {}));
  CHECK(says(refused({{2, 0.01}, {2, 0.02}}), Code::bad_value, {"2"}));
  CHECK(says(refused({{2, 0.01}, {1, 0.02}}), Code::bad_value, {"1", "2"}));
  CHECK(says(refused({{-2, 0.01}}), Code::bad_value, {"-2"}));
  CHECK(says(refused({{2, 0.01}, {3, -0.02}}), Code::bad_value, {"-0.02"}));
}

TEST_CASE("a part on a hinge: its spring makes the mode, all else is refused") {
  OnHinge good;
  good.h.torque = 50 * good.h.angle + 0.2 * good.h.rate;  // the damper is replaced
  // The panel about the hinge, root clamped: 1 + 3 0.5^2 kg m^2.
  const ModalData data =
      damping_of_assembly(good.d, "root.parent", {{"C", "panel.C"}}, 0.003).data();
  REQUIRE(data.omega.size() == 1);
  CHECK(std::abs(data.omega(0) - std::sqrt(50 / 1.75)) <= 1e-12 * data.omega(0));
  CHECK(data.xi(0) == 0.003);
  CHECK((data.children[0].PC - Vector3d(2, 0, 0)).norm() <= 1e-12);

  OnHinge loose;
  loose.h.torque = 0;
  CHECK(says(OnHinge{}.made(), Code::no_equation, {"h.accel"}));
  CHECK(says(loose.made(), Code::bad_value, {"wing", "h.angle"}));
  OnHinge active;
  active.h.torque = 50 * active.h.angle - 0.2 * active.h.rate;
  CHECK(says(active.made(), Code::bad_value, {"wing", "h.angle"}));
  OnHinge negative;
  negative.h.torque = -50 * negative.h.angle;
  CHECK(says(negative.made(), Code::bad_value, {"wing", "h.angle"}));
  OnHinge controlled;
  auto law = controlled.d.add("law", Integrator{});
  law.in = controlled.h.angle;
  controlled.h.torque = 50 * controlled.h.angle + 3 * law.out;
  CHECK(says(controlled.made(), Code::bad_value, {"wing"}));
  OnHinge held;
  held.h.torque = 50 * held.h.angle + 3 * held.panel.child("C").position.linear().along({0, 1, 0});
  CHECK(says(held.made(), Code::bad_value, {"wing"}));
}

TEST_CASE("roots, ports and signals that a body cannot have") {
  OnHinge part;
  part.h.torque = 50 * part.h.angle;
  CHECK(says(part.made("hub.parent"), Code::unknown_name, {"hub.parent", "root.parent"}));
  CHECK(says(part.made("root.parent", "panel.D"), Code::unknown_name, {"panel.D", "panel.C"}));
  CHECK(says(part.made("root.C"), Code::bad_value, {"root.C"}));
  CHECK(says(part.made("panel.parent"), Code::bad_value, {"panel.parent"}));
  CHECK(says(part.made("root.parent", "panel.parent"), Code::bad_value, {"panel.parent"}));
  const auto twice = [&] {
    damping_of_assembly(part.d, "root.parent", {{"C", "panel.C"}, {"C", "root.C"}}, 0.003);
  };
  CHECK(says(error_of(twice), Code::duplicate_name, {"C"}));
  auto loose = part.d.add("loose", RigidBody{.mass = 1, .children = {{"C"}}});
  release(loose);
  CHECK(says(part.made(), Code::bad_value, {"loose"}));
  OnHinge with_input;
  with_input.h.torque = 50 * with_input.h.angle - with_input.d.input("motor");
  CHECK(says(with_input.made(), Code::bad_value, {"motor"}));
}

TEST_CASE("damping matrices that take no energy, or do not fit") {
  ModalData data;
  data.omega = Eigen::Vector2d(3, 5);
  data.xi = Eigen::Vector2d::Zero();
  data.L_P = Eigen::MatrixXd::Zero(2, 6);
  data.D_P = Matrix6::Identity();
  const FlexibleBody body{data};
  const auto refused = [&](const Eigen::MatrixXd& Z) {
    return error_of([&] { body.damped_by(Z); });
  };
  CHECK(says(refused(Eigen::MatrixXd::Zero(3, 3)), Code::size, {"3 x 3", "2"}));
  CHECK(says(refused(Eigen::Matrix2d{{1, kNaN}, {0, 1}}), Code::not_finite, {"1", "2"}));
  CHECK(says(refused(Eigen::Matrix2d{{1, 0.5}, {0, 1}}), Code::bad_modes, {}));
  CHECK(says(refused(Eigen::Matrix2d{{1, 2}, {2, 1}}), Code::bad_modes, {"1"}));
  const FlexibleBody damped = body.damped_by(Eigen::Matrix2d{{2, 1}, {1, 2}});
  CHECK(damped.damping() == Eigen::Matrix2d{{2, 1}, {1, 2}});
  CHECK(says(error_of([&] { FlexibleBody(damped, {.xi = {{1, 0.1}}}); }), Code::bad_modes, {}));
  const FlexibleBody valued(body, {.xi = {{1, 0.1}}});
  CHECK(
      says(error_of([&] { valued.damped_by(Eigen::Matrix2d::Identity()); }), Code::bad_modes, {}));
}
