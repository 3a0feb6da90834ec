#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>

#include "assembly.hpp"
#include "stages.hpp"
#include "support/mistakes.hpp"
#include "support/promises.hpp"

/// Loops that share bodies: ladders and planar grids of beams. The work of the passes grows with
/// the structure, independent of stiff and soft parts, and the models are right.

using namespace loops_test;
using namespace titop;

namespace {

using titop::linalg::at;

struct Shape {
  int along = 2, across = 2;
  double rungs = 1;     ///< section of the rungs, in that of the rails
  bool hinged = false;  ///< rungs turn about z where they are closed
  bool rigid = false;   ///< rungs are rigid bodies
};

FlexibleBody beam(double section) {
  return Beam{.length = 2,
              .section = rectangle(0.06 * section, 0.04 * section),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 2,
              .modes = {.kept = 12, .xi = {0.005}}};
}

/// Beams between nodes; every rung but the first of a row closes a loop.
Diagram grid(const Shape& shape) {
  Diagram d{"grid"};
  const FlexibleBody rail = beam(1), rung = beam(shape.rungs);
  const RigidBody stiff{.mass = 4,
                        .inertia = Vector3d(0.1, 1.4, 1.4).asDiagonal(),
                        .PA = {1, 0, 0},
                        .children = {{"C", {2, 0, 0}}}};
  const RigidBody node{
      .mass = 5, .inertia = 0.1 * Matrix3d::Identity(), .children = {{"E"}, {"N"}, {"S"}}};
  const Rotation up = Rotation::about({0, 0, 1}, std::numbers::pi / 2);
  std::vector<BodyHandle> nodes;
  for (int j = 0; j < shape.across; ++j)
    for (int i = 0; i < shape.along; ++i) {
      const std::string place = std::to_string(i + 1) + "_" + std::to_string(j + 1);
      nodes.push_back(d.add("N" + place, node));
      if (i > 0) {
        auto b = d.add("H" + place, rail);
        mount(b, nodes[at(shape.along * j + i - 1)].child("E"));
        mount(nodes.back(), b.child);
      }
      if (j == 0) continue;
      const auto& site = nodes[at(shape.along * (j - 1) + i)].child("N");
      const auto close = [&](const auto& far) {
        if (i == 0)
          mount(nodes.back(), far, up.inverse());
        else if (shape.hinged) {
          auto pin = d.add("P" + place, Hinge{{0, 0, 1}});
          pin.torque = -0.3 * pin.rate;
          mount(pin, nodes.back().child("S"), up);
          weld(far, pin.child);
        } else
          weld(far, nodes.back().child("S"), up);
      };
      if (shape.rigid) {
        auto b = d.add("V" + place, stiff);
        mount(b, site, up), close(b.child);
      } else {
        auto b = d.add("V" + place, rung);
        mount(b, site, up), close(b.child);
      }
    }
  nodes.front().parent.force = -d.input("U", 6);
  d.output("a", 6) = nodes.back().parent.accel;
  return d;
}

}  // namespace

TEST_CASE("ladders and grids: the passes keep their promises, every rung closes six relations") {
  for (const Shape& shape :
       {Shape{5, 2}, Shape{5, 2, 0.1}, Shape{5, 2, 8}, Shape{3, 4}, Shape{3, 3, 0.1},
        Shape{4, 2, 1, true}, Shape{4, 2, 1, false, true}, Shape{3, 3, 1, true}}) {
    CAPTURE(shape.along);
    CAPTURE(shape.across);
    CAPTURE(shape.rungs);
    CAPTURE(shape.hinged);
    CAPTURE(shape.rigid);
    const Diagram d = grid(shape);
    CHECK_NOTHROW(titop_test::demand_not_redundant(until_chains(d)));
    const Stage closed = until_close(d);
    CHECK_NOTHROW(titop_test::demand_closed(closed));
    const int loops = (shape.along - 1) * (shape.across - 1);
    CHECK(closed.dependents.size() == at(2 * 6 * loops));
  }
}

TEST_CASE("ladders and grids: the dense model answers as the equations as written") {
  for (const Shape& shape : {Shape{4, 2}, Shape{4, 2, 0.1}, Shape{3, 3, 0.3}, Shape{3, 2, 1, true},
                             Shape{3, 2, 1, false, true}}) {
    CAPTURE(shape.along);
    CAPTURE(shape.rungs);
    const Diagram d = grid(shape);
    const System system = compile(d, {.minimize_up_to = 0});
    std::vector<MatrixXcd> dense, factored, written;
    for (const Complex s : {Complex(0.3, 4), Complex(2, 30), Complex(1, 900)}) {
      dense.push_back(system.state_space().transfer(s));
      factored.push_back(system.transfer(s));
      written.push_back(transfer(d.graph(), s));
    }
    CHECK(by_hand::transfer_error(factored, written) <= 1e-9);
    CHECK(by_hand::transfer_error(dense, written) <= 1e-8);
  }
}

TEST_CASE("dependent coordinates: linear in the bays of a ladder, n^1.5 log n in a grid") {
  for (const double rungs : {1.0, 0.1, 8.0}) {
    CAPTURE(rungs);
    const auto count = [&](int along, int across) { return entries(grid({along, across, rungs})); };
    CHECK(count(81, 2) <= 4.4 * count(21, 2));
    CHECK(count(17, 17) <= 8.0 * 4 / 3 * count(9, 9));  // 64 and 256 loops
  }
}

TEST_CASE("two stiff supports beside a slide: stiff directions are constraints like the others") {
  // The slide leaves x; both bushings fix the rest, by springs up to 1e8 times stiffer.
  for (const double ratio : {1.0, 2e6, 1e8}) {
    CAPTURE(ratio);
    Diagram d{"supports"};
    auto S = d.add("S", Slide{{1, 0, 0}});
    ground(S);
    S.force = 0.3 * S.rate;
    auto B = d.add(
        "T",
        RigidBody{.mass = 4, .inertia = Vector3d(0.1, 1.4, 1.4).asDiagonal(), .children = {{"a"}}});
    mount(B, S.child);
    for (int i = 0; i < 2; ++i) {
      const double k = 100;
      auto K = d.add("U" + std::to_string(i),
                     Bushing{.stiffness = {k, k * ratio, k * ratio, k, k * ratio, k * ratio},
                             .damping = {1, 1, 1, 1, 1, 1}});
      ground(K);
      weld(K.child, B.child("a"));
    }
    B.child("a").force += d.input("F", 6);
    d.output("a", 6) = B.child("a").accel;
    const System system = compile(d, {.minimize_up_to = 0});
    CHECK(system.order() == 2);
    const Complex s(0.3, 5);
    const Complex exact = s * s / (4.0 * s * s + (2.0 + 0.3) * s + 200.0);
    CHECK(std::abs(system.state_space().transfer(s)(0, 0) - exact) <= 1e-12 * std::abs(exact));
  }
}

TEST_CASE("ladders: positions and rates of the same coordinates follow, and stay after an update") {
  for (const double rungs : {1.0, 0.1}) {
    const auto scene = [&](double turn) {
      Diagram d{"twisted"};
      const Param phi = d.param("phi", turn);
      const RigidBody node{
          .mass = 5, .inertia = 0.1 * Matrix3d::Identity(), .children = {{"E"}, {"N"}, {"S"}}};
      const Rotation up =
          Rotation::about({0, 0, 1}, std::numbers::pi / 2) * Rotation::about({1, 0, 0}, Value(phi));
      std::vector<BodyHandle> nodes;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 4; ++i) {
          const std::string place = std::to_string(i) + "_" + std::to_string(j);
          nodes.push_back(d.add("N" + place, node));
          if (i > 0) {
            auto b = d.add("H" + place, beam(1));
            mount(b, nodes[at(4 * j + i - 1)].child("E")), mount(nodes.back(), b.child);
          }
          if (j == 0) continue;
          auto b = d.add("V" + place, beam(rungs));
          mount(b, nodes[at(i)].child("N"), up);
          i == 0 ? mount(nodes.back(), b.child, up.inverse())
                 : weld(b.child, nodes.back().child("S"), up);
        }
      nodes.front().parent.force = -d.input("U", 6);
      d.output("a", 6) = nodes.back().parent.accel;
      return d;
    };
    const System before = compile(scene(0.2), {.minimize_up_to = 0});
    const std::vector<std::string>& names = before.states();
    for (const std::string& name : names)
      if (!name.ends_with("_rate"))
        CHECK(std::count(names.begin(), names.end(), name + "_rate") == 1);
    const System after = before.update({{"phi", 1.3}});
    CHECK(after.states() == names);
    const Complex s(0.3, 40);
    CHECK(by_hand::transfer_error({after.transfer(s)},
                                  {compile(scene(1.3)).transfer(s, Precision::digits50)}) <= 1e-11);
  }
}
