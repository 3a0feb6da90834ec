#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

// Modal data and beams that no body has: each entry, and the line that makes the body.

using namespace titop;
using namespace titop_test;

TEST_CASE("bad-inertia: a D_P that no body has") {
  // 40 kg around (0, 3, 0): an appendage without modes, by hand.
  ModalData data;
  data.L_P.resize(0, 6);
  data.D_P = rigid_mass(40, Vector3d(120, 10, 130).asDiagonal(), {0, -3, 0});
  const auto refused_with = [&](auto change) {
    ModalData d = data;
    change(d);
    return error_of([&] { FlexibleBody{d}; });
  };
  CHECK(refused_with([](ModalData&) {}).mistakes().empty());
  CHECK(says(refused_with([](ModalData& d) { d.D_P(0, 0) = 50; }), Code::bad_inertia,
             {"D_P", "50", "(x, x)", "43.3333"}));
  CHECK(says(refused_with([](ModalData& d) {
               Matrix6 swapped;
               swapped << d.D_P.bottomRightCorner<3, 3>(), d.D_P.bottomLeftCorner<3, 3>(),
                   d.D_P.topRightCorner<3, 3>(), d.D_P.topLeftCorner<3, 3>();
               d.D_P = swapped;
             }),
             Code::bad_inertia, {"D_P", "x, y, z, rx, ry, rz"}));
  CHECK(says(refused_with([](ModalData& d) { d.D_P(0, 5) = 3; }), Code::bad_inertia,
             {"D_P", "3", "(x, rz)", "-120", "(rz, x)"}));
  // The inertia about the centre of mass in place of that about P, 360 kg m^2 more: not the modes'
  // fault, as there are none. Scaled to a unit diagonal the least eigenvalue is
  // 1 - 120 / sqrt(40 120) = 1 - sqrt(3) = -0.73.
  CHECK(says(refused_with([](ModalData& d) {
               d.D_P.bottomRightCorner<3, 3>() = Vector3d(120, 10, 130).asDiagonal();
             }),
             Code::bad_inertia, {"D_P", "0.73"}));
  // Data of two digits may be off by a tenth: a twentieth is no mistake.
  CHECK(refused_with([](ModalData& d) { d.D_P(0, 0) = 42, d.digits = 2; }).mistakes().empty());
}

TEST_CASE("numbers of modal data that make no sense") {
  ModalData data;
  data.omega = Eigen::Vector2d(3, 7);
  data.xi = Eigen::Vector2d(0.01, 0.01);
  data.L_P = Eigen::MatrixXd::Zero(2, 6);
  data.D_P = rigid_mass(5, Matrix3d::Identity(), Vector3d::Zero());
  data.children.push_back({"C1", {0, 0, 0}, Eigen::MatrixXd::Zero(6, 2)});
  const auto refused_with = [&](auto change) {
    ModalData d = data;
    change(d);
    return error_of([&] { FlexibleBody{d}; });
  };
  CHECK(refused_with([](ModalData&) {}).mistakes().empty());
  for (const double digits : {0.0, -1.0, std::nan(""), HUGE_VAL})
    CHECK(says(refused_with([&](ModalData& d) { d.digits = digits; }), Code::bad_value,
               {"digits", fmt::format("{}", digits)}));
  // Percent. Damping in proportion to stiffness gives fast modes ratios above 1.
  CHECK(says(refused_with([](ModalData& d) { d.xi = Eigen::Vector2d(50, 40); }), Code::bad_modes,
             {"xi", "40"}));
  CHECK(refused_with([](ModalData& d) { d.xi(1) = 3; }).mistakes().empty());
  CHECK(says(refused_with([](ModalData& d) { d.L_P(1, 2) = std::nan(""); }), Code::not_finite,
             {"L_P", "nan", "row 2", "column 3"}));
  CHECK(says(refused_with([](ModalData& d) { d.children[0].Phi_C(5, 0) = HUGE_VAL; }),
             Code::not_finite, {"Phi_C", "C1", "inf", "row 6", "column 1"}));
}

TEST_CASE("mistakes of modal data and beams are told with the line that makes the body") {
  ModalData data;
  data.L_P.resize(0, 6);
  data.D_P = -Matrix6::Identity();
  const auto body = next_line();
  const Error by_data = error_of([&] { FlexibleBody{data}; });
  CHECK(says(by_data, Code::bad_inertia, {"D_P", "-1", "x", body}));
  const auto beam = next_line();
  const Error by_beam = error_of([&] { FlexibleBody{Beam{}}; });
  CHECK(says(by_beam, Code::bad_value, {"length", "0", beam}));
  const auto rigid = next_line();
  const Error by_rigid = error_of([&] { FlexibleBody{RigidBody{.mass = -1}}; });
  CHECK(says(by_rigid, Code::bad_inertia, {"mass", "-1", rigid}));
}
