#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <titop/blocks/posture.hpp>

#include "support/mistakes.hpp"

/// Postures of mechanisms against their closed forms.

using namespace titop;
using titop_test::error_of;
using titop_test::says;

namespace {

constexpr double pi = 3.14159265358979323846;
const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

/// The same angle up to whole turns.
double turned(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

constexpr double a = 0.3, b = 0.9, c = 0.7, d = 1.0;  // crank, coupler, rocker, frame [m]

std::vector<LoopStep> four_bar(double theta, double guess1, double guess2) {
  return {{.joint = about(z, "crank"), .given = theta, .link = {a, 0, 0}},
          {.joint = about(z, "coupler"), .guess = guess1, .link = {b, 0, 0}},
          {.joint = about(z, "rocker"), .guess = guess2, .link = {c, 0, 0}},
          {.joint = about(z, "frame"), .link = {-d, 0, 0}}};
}

/// Follows the mounting rotations round the loop, as a scene does: where does it end?
double open_by(const std::vector<LoopStep>& loop, const Posture& p) {
  Matrix3d R = Matrix3d::Identity();
  Vector3d at = Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    at += R * p.offset[i];
    R = R * p.T_ba[i].nominal();
    at += R * loop[i].link;
  }
  return at.norm() + (R - Matrix3d::Identity()).norm();
}

/// Bennett's linkage: opposite links equal, lengths as the sines of the twists.
std::vector<LoopStep> bennett(double theta, double alpha, double beta, double length_b) {
  const Vector3d link_a(0.4, 0, 0), link_b(length_b, 0, 0);
  const Rotation A = Rotation::about(x, alpha), B = Rotation::about(x, beta);
  return {{.joint = about(z), .given = theta, .link = link_a, .turn = A},
          {.joint = about(z), .guess = 1, .link = link_b, .turn = B},
          {.joint = about(z), .guess = -theta, .link = link_a, .turn = A},
          {.joint = about(z), .guess = -1, .link = link_b, .turn = B}};
}

}  // namespace

TEST_CASE("four-bar: the cosine rule, on both branches, a whole turn of the crank") {
  for (const double branch : {1.0, -1.0}) {
    double guess1 = branch, guess2 = -branch;
    for (double theta = 0.1; theta < 2 * pi; theta += 0.3) {
      const Eigen::Vector2d A(a * std::cos(theta), a * std::sin(theta)), D(d, 0);
      const Eigen::Vector2d f = D - A;
      const double alpha = std::acos((b * b + f.squaredNorm() - c * c) / (2 * b * f.norm()));
      const double coupler = std::atan2(f.y(), f.x()) + branch * alpha;
      const Eigen::Vector2d B = A + b * Eigen::Vector2d(std::cos(coupler), std::sin(coupler));
      const double down = std::atan2(D.y() - B.y(), D.x() - B.x());  // from B to D

      const auto loop = four_bar(theta, guess1, guess2);
      const Posture p = posture(loop);
      CAPTURE(theta);
      CHECK(p.values[0] == theta);
      CHECK(turned(p.values[1], coupler - theta) <= 1e-12);
      CHECK(turned(p.values[2], down - coupler) <= 1e-12);
      CHECK(turned(p.values[3], -down) <= 1e-12);
      CHECK(std::abs(p.values[1] - guess1) <= pi);
      CHECK(open_by(loop, p) <= 1e-13);
      CHECK(p.gap <= 1e-13);
      CHECK(p.gap_angle <= 1e-13);
      // Freudenstein: the rocker seen from D.
      const double rocker = down + pi;
      CHECK(std::abs(d / a * std::cos(rocker) - d / c * std::cos(theta) +
                     (a * a - b * b + c * c + d * d) / (2 * a * c) - std::cos(theta - rocker)) <=
            1e-13);
      guess1 = p.values[1], guess2 = p.values[2];
    }
  }
}

TEST_CASE("slider-crank: a prismatic joint, and its travel") {
  for (const double theta : {0.2, 1.1, 2.9, 4.0}) {
    const std::vector<LoopStep> loop{
        {.joint = about(z), .given = theta, .link = {a, 0, 0}},
        {.joint = about(z), .guess = -theta, .link = {b, 0, 0}},
        {.joint = about(z), .link = {0, 0.1, 0}},  // the cylinder's frame is the ground's
        {.joint = along({-2, 0, 0}), .guess = b, .link = {0, -0.1, 0}}};
    const Posture p = posture(loop);
    const double s = a * std::sin(theta);
    const double travel = a * std::cos(theta) + std::sqrt(b * b - s * s);
    CHECK(std::abs(p.values[3] - travel) <= 1e-13);
    CHECK((p.offset[3] - Vector3d(-travel, 0, 0)).norm() <= 1e-13);
    CHECK(turned(p.values[1], -std::asin(s / b) - theta) <= 1e-12);
    CHECK(open_by(loop, p) <= 1e-13);
  }
}

TEST_CASE("a jack given, the angles follow: law of cosines") {
  const double base = 0.5, arm = 0.4, jack = 0.6;
  const Posture p = posture({{.joint = about(z), .guess = 1, .link = {arm, 0, 0}},
                             {.joint = about(z), .guess = -2},
                             {.joint = along(x), .given = jack},
                             {.joint = about(z), .guess = 1, .link = {-base, 0, 0}}});
  const double elevation = std::acos((base * base + arm * arm - jack * jack) / (2 * base * arm));
  CHECK(std::abs(p.values[0] - elevation) <= 1e-13);
  CHECK(p.values[2] == jack);
}

TEST_CASE("Cardan: two shafts at an angle, only rotations") {
  const double beta = 0.6;
  for (const double theta : {0.3, 1.0, -0.8}) {
    const Posture p = posture({{.joint = about(z, "in"), .given = theta},
                               {.joint = about(x)},
                               {.joint = about(y)},
                               {.joint = about(z, "out"), .turn = Rotation::about(x, -beta)}});
    CHECK(turned(-p.values[3], std::atan(std::cos(beta) * std::tan(theta))) <= 1e-12);
  }
}

TEST_CASE("Bennett: a spatial loop that only its proportions let move") {
  const double alpha = 0.5, beta = 1.2, length_b = 0.4 * std::sin(beta) / std::sin(alpha);
  for (const double theta : {0.4, 1.0, 2.0}) {
    const auto loop = bennett(theta, alpha, beta, length_b);
    const Posture p = posture(loop);
    const double other = 2 * std::atan(std::sin((beta + alpha) / 2) / std::sin((beta - alpha) / 2) /
                                       std::tan(theta / 2));
    CAPTURE(theta);
    CHECK(turned(p.values[1], other) <= 1e-10);
    CHECK(turned(p.values[2], -theta) <= 1e-10);
    CHECK(turned(p.values[3], -other) <= 1e-10);
    CHECK(open_by(loop, p) <= 1e-12);
    // With rounded data it closes to the accuracy of the data, if the tolerance allows it.
    const auto rounded = bennett(theta, alpha, beta, length_b * (1 + 1e-7));
    CHECK(error_of([&] { posture(rounded); }).has(Code::kinematic_loop));
    CHECK(turned(posture(rounded, {.tolerance = 1e-6}).values[1], other) <= 1e-5);
  }
}

TEST_CASE("a loop that cannot be closed is refused with the gap") {
  // Links of 1 m and 1 m between points 3 m apart.
  CHECK(says(error_of([] {
               posture({{.joint = about(z, "A"), .guess = 0.3, .link = {1, 0, 0}},
                        {.joint = about(z), .guess = 0.2, .link = {1, 0, 0}},
                        {.joint = about(z, "C"), .link = {-3, 0, 0}}});
             }),
             Code::kinematic_loop, {"A", "C", "1 m"}));
  CHECK(says(error_of([] {
               posture({{.joint = about(z), .given = 0.5, .link = {1, 0, 0}},
                        {.joint = about(z), .given = 2.0, .link = {1, 0, 0}},
                        {.joint = about(z), .given = -2.5, .link = {0, 0, 0}}});
             }),
             Code::kinematic_loop, {"joint 1", "joint 3"}));
  CHECK(says(error_of([] {
               posture({{.joint = about(z), .given = 0.5, .turn = Rotation::about(x, 0.2)},
                        {.joint = about(z), .guess = -0.5}});
             }),
             Code::kinematic_loop, {"0 m", "0.2 rad"}));
}

TEST_CASE("a bad guess is no refusal: other starts are tried") {
  const auto loop = four_bar(0.7, 3.1, 3.1);
  CHECK(open_by(loop, posture(loop)) <= 1e-13);
  const auto again = posture(loop);
  CHECK(again.values == posture(loop).values);
}

TEST_CASE("a loop that can still move is refused with its joints, at a dead centre too") {
  auto five_bar = four_bar(0.7, -0.5, -1);
  five_bar.insert(five_bar.begin() + 2, {.joint = about(z, "knee"), .link = {0.2, 0, 0}});
  CHECK(
      says(error_of([&] { posture(five_bar); }), Code::singular, {"coupler, knee, rocker, frame"}));
  const std::vector<LoopStep> flat{{.joint = about(z, "A"), .given = 0, .link = {0.5, 0, 0}},
                                   {.joint = about(z, "B"), .guess = 0.1, .link = {1, 0, 0}},
                                   {.joint = about(z, "C"), .guess = pi, .link = {0.5, 0, 0}},
                                   {.joint = about(z, "D"), .guess = pi, .link = {1, 0, 0}}};
  CHECK(says(error_of([&] { posture(flat); }), Code::singular, {"B, C, D"}));
}

TEST_CASE("data that make no loop") {
  CHECK(says(error_of([] { posture({}); }), Code::bad_value, {}));
  CHECK(says(error_of([] {
               posture({{.joint = about({0, 0, 0})}});
             }),
             Code::bad_value, {"axis", "(0, 0, 0)"}));
  CHECK(says(error_of([] { posture({{.joint = about(z, "A"), .given = std::nan("")}}); }),
             Code::not_finite, {"A"}));
}
