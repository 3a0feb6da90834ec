#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Motions that the data's digits cannot determine are refused, in any directions: a parent freed
/// without remaining mass, a child driven where its modes do not move it.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

Beam boom(std::optional<int> kept = {}) {
  Beam b{.length = 2,
         .section = rectangle(0.06, 0.04),
         .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
         .elements = 10,
         .modes = {.xi = {0.005}}};
  if (kept) b.modes.kept = *kept;
  return b;
}

MatrixXd rounded(MatrixXd m, int digits) {
  for (double& x : m.reshaped()) x = std::strtod(fmt::format("{:.{}e}", x, digits - 1).c_str(), {});
  return m;
}

/// All modes, and no mass left in these directions (all six where empty), written in so many
/// digits.
ModalData bare(int digits, std::optional<int> direction = {}) {
  ModalData data = modal_data(boom());
  const Matrix6 D_P0 = residual_mass(data).D_P0;
  if (direction)
    data.D_P -= D_P0.col(*direction) * D_P0.row(*direction) / D_P0(*direction, *direction);
  else
    data.D_P -= D_P0;
  data.D_P = rounded((data.D_P + data.D_P.transpose()) / 2, digits);
  data.L_P = rounded(data.L_P, digits);
  for (ModalChild& c : data.children) c.Phi_C = rounded(c.Phi_C, digits);
  data.digits = digits;
  return data;
}

bool is_in(int set, int i) { return (set >> i & 1) != 0; }

/// Freed in the directions of a set of bits, held in the others.
Diagram freed(const FlexibleBody& body, int set) {
  Diagram d{"freed"};
  auto b = d.add("b", body);
  for (int i = 0; i < 6; ++i) {
    if (is_in(set, i)) continue;
    const Vector3d r = Vector3d::Unit(i % 3);
    i < 3 ? ground(b.parent.along(r)) : ground(b.parent.about(r));
  }
  release(b);
  b.child.force = d.input("u", 6);
  d.output("a", 6) = b.child.accel;
  return d;
}

/// D_P0 among these directions, relative to D_P: its least eigenvalue.
double left(const ModalData& data, int set) {
  std::vector<int> free;
  for (int i = 0; i < 6; ++i)
    if (is_in(set, i)) free.push_back(i);
  const Vector6 scale = data.D_P.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 D_P0 = data.D_P - data.L_P.transpose() * data.L_P;
  const MatrixXd part = (scale.asDiagonal() * D_P0 * scale.asDiagonal()).eval()(free, free);
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(part).eigenvalues()(0);
}

/// Refused by the digits of the data: the mistake names the port. One of an exact 0 names its force
/// and its acceleration.
bool by_digits(const Error& e, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(e.mistakes(), [&](const Mistake& m) {
    return m.code == Code::improper && has_name(m.message, "b.parent") &&
           !has_name(m.message, "b.parent.force") && has_names(text_of_mistake(m), names);
  });
}

}  // namespace

TEST_CASE("data digits: a parent freed in each of the 63 sets of directions") {
  int refused = 0;
  for (const int digits : {7, 15})
    for (const int direction : {-1, 1, 5}) {
      const ModalData data = direction < 0 ? bare(digits) : bare(digits, direction);
      const FlexibleBody body{data};
      for (int set = 1; set < 64; ++set) {
        CAPTURE(digits);
        CAPTURE(direction);
        CAPTURE(set);
        const bool zero = direction < 0 || is_in(set, direction);
        const double fraction = left(data, set);
        REQUIRE((zero ? fraction < 1e-6 : fraction > 2e-6));
        const Error e = compile_error(freed(body, set));
        CHECK(zero == by_digits(e, {"P"}));
        CHECK(zero != e.mistakes().empty());
        refused += zero;
      }
    }
  CHECK(refused == 2 * (63 + 32 + 32));
}

TEST_CASE("data digits: freed by joints, along oblique axes, through points without mass") {
  const FlexibleBody body{bare(7)};
  const Vector3d axis{1, 2, 3};
  const auto scene = [&](auto hang) {
    Diagram d{"joint"};
    auto hub = d.add("hub", RigidBody{.children = {{"S", {1, 0, 0}}}});
    auto b = d.add("b", body);
    b.child.force = d.input("u", 6);
    d.output("a", 6) = b.child.accel;
    hang(d, hub, b);
    return compile_error(d);
  };
  CHECK(by_digits(
      scene([&](Diagram& d, auto& hub, auto& b) {
        ground(hub);
        hinge(d, "h", b, hub.child("S"), Rotation::about({0, 1, 0}, 0.7), axis).torque = 0;
      }),
      {"rx + 2 ry + 3 rz"}));
  CHECK(
      by_digits(scene([&](Diagram& d, auto& hub, auto& b) {
                  ground(hub);
                  slide(d, "s", b, hub.child("S"), Rotation::about({0, 1, 0}, 0.7), axis).force = 0;
                }),
                {"x + 2 y + 3 z"}));
  CHECK(by_digits(scene([&](Diagram& d, auto& hub, auto& b) {
                    ground(hub);
                    bushing(d, "k", b, hub.child("S"), {}, {.stiffness = {1, 1, 1, 1, 1, 1}});
                  }),
                  {"P"}));
  // A hub with a mass supplies the missing mass.
  CHECK(scene([&](Diagram&, auto& hub, auto& b) {
          release(hub);
          mount(b, hub.child("S"));
        })
            .mistakes()
            .empty());
}

namespace {

/// Held at its parent, its child's acceleration prescribed in the directions of a set.
Diagram driven(const FlexibleBody& body, int set) {
  Diagram d{"driven"};
  auto b = d.add("b", body);
  ground(b);
  for (int i = 0; i < 6; ++i) {
    if (!is_in(set, i)) continue;
    const Vector3d r = Vector3d::Unit(i % 3);
    auto u = d.input(fmt::format("u{}", i));
    i < 3 ? b.child.accel.linear.along(r) = u : b.child.accel.angular.along(r) = u;
  }
  release(b.child);
  d.output("f", 6) = b.child.force;
  return d;
}

}  // namespace

TEST_CASE("data digits: a child driven where its modes do not move it") {
  ModalData data = modal_data(boom(4));  // two bendings in each plane
  for (const int row : {0, 3}) data.children[0].Phi_C.row(row).setConstant(1e-15);
  for (int set = 1; set < 64; ++set) {
    CAPTURE(set);
    const bool still = is_in(set, 0) || is_in(set, 3);
    const Error e = compile_error(driven(FlexibleBody{data}, set));
    CHECK(still == says(e, Code::improper, {"b.child(\"C\")"}));
    CHECK(still != e.mistakes().empty());
  }
}

TEST_CASE("data digits: forces that only residual vectors can carry") {
  Beam few = boom(2), whole = boom();  // one bending in each plane, and all modes
  few.modes.xi = whole.modes.xi = {};
  Beam carried = few;
  carried.modes.residual = {"C"};
  const MatrixXd Phi = modal_data(few).children.front().Phi_C;
  int refused = 0;
  for (int set = 1; set < 64; ++set) {
    CAPTURE(set);
    std::vector<int> rows;
    for (int i = 0; i < 6; ++i)
      if (is_in(set, i)) rows.push_back(i);
    const Eigen::JacobiSVD<MatrixXd> svd(Phi(rows, Eigen::all));
    const bool moved =
        rows.size() <= 2 && svd.singularValues().minCoeff() > 1e-6 * Phi.cwiseAbs().maxCoeff();
    const Error e = compile_error(driven(FlexibleBody{few}, set));
    CHECK(moved == e.mistakes().empty());
    refused += !e.mistakes().empty();
    const System some = compile(driven(FlexibleBody{carried}, set)),
                 all = compile(driven(FlexibleBody{whole}, set));
    const std::complex<double> s(0, 0.1);  // the first mode is at 52 rad/s
    const Eigen::MatrixXcd exact = all.transfer(s);
    CHECK((some.transfer(s) - exact).norm() <= 1e-6 * exact.norm());
  }
  CHECK(refused == 63 - 8);
}

TEST_CASE("data digits: of a body with a damping matrix, and of values in rows of zeros") {
  const ModalData none = bare(7);
  const auto n = none.omega.size();
  const FlexibleBody damped = FlexibleBody{none}.damped_by(0.1 * MatrixXd::Identity(n, n));
  for (const int set : {1, 8, 63}) CHECK(by_digits(compile_error(freed(damped, set)), {"P"}));
  ModalData data = modal_data(boom(4));
  for (const int row : {0, 3}) data.children[0].Phi_C.row(row).setZero();
  for (const double entry : {1e-14, 0.3}) {
    CAPTURE(entry);
    Diagram d{"driven"};
    auto b = d.add("b", FlexibleBody{FlexibleBody{data}, {.Phi_C = {{"C", {{1, 1, entry}}}}}});
    ground(b);
    b.child.accel.linear.along({1, 0, 0}) = d.input("u");
    release(b.child);
    d.output("f", 6) = b.child.force;
    CHECK((entry < 1e-3) == says(compile_error(d), Code::improper, {"b.child(\"C\")"}));
  }
}

TEST_CASE("data digits: a contradictory support that nothing depends on is told") {
  for (const int kept : {2, 4, 20}) {
    CAPTURE(kept);
    Diagram d{"support"};
    auto b = d.add("b", FlexibleBody{boom(kept)});
    b.parent.accel = d.input("u", 6);
    ground(b.child);
    d.output("a", 6) = b.parent.accel;
    const bool told = noted(compile(d), Note::Kind::warning, "digits", {"b.child(\"C\")"});
    CHECK(told == (kept < 6));
  }
}
