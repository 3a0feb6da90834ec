#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <titop/compiler/passes/passes.hpp>

#include "assembly.hpp"
#include "support/promises.hpp"

/// Loops that share bodies: ladders and planar grids of beams. What the passes do grows with the
/// structure, whatever stands between stiff and soft, and the models are right.

using namespace loop_test;
using namespace titop;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

Stage until_chains(const Diagram& d) {
  Stage stage;
  stage.graph = d.graph();
  for (const auto pass : {passes::check, passes::lower, passes::split, passes::chains})
    stage = pass(std::move(stage));
  return stage;
}

Stage until_close(const Diagram& d) {
  Stage stage = until_chains(d);
  for (const auto pass : {passes::match, passes::order, passes::close})
    stage = pass(std::move(stage));
  return stage;
}

/// Entries of the map from the states that stay.
double entries(const Shape& shape) {
  double count = 0;
  for (const Dependent& d : until_close(grid(shape)).dependents)
    count += static_cast<double>(d.of.size());
  return count;
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

TEST_CASE("what follows from what: linear in the bays of a ladder, n^1.5 log n in a grid") {
  for (const double rungs : {1.0, 0.1, 8.0}) {
    CAPTURE(rungs);
    CHECK(entries({81, 2, rungs}) <= 4.4 * entries({21, 2, rungs}));
    CHECK(entries({17, 17, rungs}) <= 8.0 * 4 / 3 * entries({9, 9, rungs}));  // 64 and 256 loops
  }
}
