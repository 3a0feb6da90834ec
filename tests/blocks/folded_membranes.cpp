#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

#include "support/mistakes.hpp"

/// Thin-walled sections of membranes that are welded along their long edges at any angle, between
/// rigid ends: torsion of tubes by Bredt's formula, bending by the section's moments of area.

using namespace titop;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using std::numbers::pi;
using titop_test::error_of;
using titop_test::says;

namespace {

constexpr double kWidth = 0.2, kLength = 0.6, kThickness = 0.001, kE = 70e9;
constexpr int kAlong = 6;

/// A wall along y with the ends "root" and "tip" and the lines "left" and "right", which end at the
/// last nodes before the ends.
ModalData wall(double nu, InPlane in_plane = InPlane::membrane) {
  const Plate plate{.a = kWidth,
                    .b = kLength,
                    .thickness = kThickness,
                    .material = {.E = kE, .nu = nu, .rho = 2700},
                    .elements = {2, kAlong},
                    .in_plane = in_plane};
  fe::Mesh mesh = plate_mesh(plate);
  mesh = fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "y0")));
  mesh = fe::with_interface(mesh, "tip", fe::rigid(fe::edge(mesh, "y1")));
  const double h = 1.0 / kAlong;
  for (const auto& [name, edge] : {std::pair{"left", "x0"}, {"right", "x1"}})
    mesh = fe::with_interface(mesh, name,
                              fe::shapes(fe::segment(mesh, edge, h, 1 - h), fe::legendre(3)));
  return fe::modal_data(mesh, "root", {"tip", "left", "right"},
                        {.kept = 4, .residual = {"tip", "left", "right"}});
}

/// Walls in a row, each turned by `turn` about the edge that it has in common with the one before.
struct Profile {
  int walls;
  double turn;
  bool closed;

  /// Direction of a wall across, as x and z of the first wall's frame.
  Vector2d along(int k) const { return {std::cos(k * turn), -std::sin(k * turn)}; }
  Vector2d start(int k) const {
    Vector2d at = Vector2d::Zero();
    for (int i = 0; i < k; ++i) at += kWidth * along(i);
    return at;
  }
  Vector2d middle(int k) const { return start(k) + kWidth / 2 * along(k); }
  Vector2d centre() const {
    Vector2d sum = Vector2d::Zero();
    for (int k = 0; k < walls; ++k) sum += middle(k);
    return sum / walls;
  }
};

Rotation fold(double angle) { return Rotation::about({0, 1, 0}, angle); }

/// Rotation of the tip per torque there, about y, x and z of the first wall, with the root fixed.
Matrix3d rotations(const Profile& profile, const ModalData& data) {
  Diagram d{"section"};
  std::vector<FlexibleBodyHandle> walls;
  RigidBody end{.mass = 1, .inertia = Matrix3d::Identity()};
  for (int k = 0; k < profile.walls; ++k) {
    walls.push_back(d.add(fmt::format("w{}", k), FlexibleBody{data}));
    ground(walls.back());
    const Vector2d at = profile.middle(k) - profile.middle(0);
    end.children.push_back({fmt::format("{}", k), Vector3d(at.x(), 0, at.y())});
  }
  const auto frame = d.add("end", end);
  mount(frame, walls[0].child("tip"));
  for (int k = 1; k < profile.walls; ++k)
    weld(walls[static_cast<std::size_t>(k)].child("tip"), frame.child(fmt::format("{}", k)),
         fold(k * profile.turn));
  for (int k = 1; k < profile.walls + (profile.closed ? 1 : 0); ++k)
    weld(walls[static_cast<std::size_t>(k % profile.walls)].line("left"),
         walls[static_cast<std::size_t>(k - 1)].line("right"), fold(profile.turn));
  frame.child("0").force += d.input("F", 6);
  d.output("x", 6) = frame.child("0").position;
  const std::vector<int> about = {4, 3, 5};
  return compile(d).static_gain()(about, about);
}

}  // namespace

TEST_CASE("regular tubes of 3, 4 and 6 walls in torsion: Bredt's formula") {
  const double nu = 0.3, G = kE / (2 * (1 + nu));
  const ModalData data = wall(nu);
  for (const int n : {3, 4, 6})
    for (const int side : {1, -1}) {
      // J = 4 A^2 t / (n b): with r, the inscribed circle, A = n b r / 2. Each wall by itself is
      // twisted with b t^3 / 3; its clamped ends make it up to twice as stiff.
      const double r = kWidth / (2 * std::tan(pi / n)), J = n * kWidth * kThickness * r * r,
                   of_walls = n * kWidth * std::pow(kThickness, 3) / 3;
      const double found = kLength / (G * rotations({n, side * 2 * pi / n, true}, data)(0, 0));
      INFO(n, " walls: J ", found, ", Bredt ", J, ", walls ", of_walls);
      CHECK(found >= J * (1 - 1e-7));
      CHECK(found <= (J + 2 * of_walls) * (1 + 1e-7));
    }
}

TEST_CASE("sections in bending by two moments: flat, angles, channels and tubes") {
  const ModalData data = wall(0);
  const double t = kThickness, h = kLength / kAlong;
  for (const Profile& s : {Profile{1, 0, false},
                           {2, 0, false},
                           {2, pi / 2, false},
                           {2, -pi / 3, false},
                           {3, pi / 2, false},
                           {3, 2 * pi / 3, true},
                           {4, pi / 2, true}}) {
    // Moments of area: in-plane and normal ones of each wall and those of its place. Bilinear
    // elements of length h in pure bending have the shear energy of b t h^2 / 24 more.
    Matrix2d J = Matrix2d::Zero();
    for (int k = 0; k < s.walls; ++k) {
      const Vector2d e = s.along(k), n(-e.y(), e.x()), at = s.middle(k) - s.centre();
      J += kWidth * t *
           (at * at.transpose() + (kWidth * kWidth + h * h / 2) / 12 * e * e.transpose() +
            t * t / 12 * n * n.transpose());
    }
    // Curvature (x, z) of the axis turns the tip about (z, -x).
    const Matrix2d turn = (Matrix2d() << 0, 1, -1, 0).finished();
    const Matrix2d expected = kLength / kE * turn * J.inverse() * turn.transpose();
    const Matrix2d found = rotations(s, data).bottomRightCorner<2, 2>();
    INFO(s.walls, " walls, ", s.turn, ":\n", found, "\nexpected\n", expected);
    CHECK((found - expected).cwiseAbs().maxCoeff() <= 1e-9 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("a membrane and a plate that is rigid in its plane meet at no oblique angle") {
  Diagram d{"fold"};
  auto a = d.add("a", FlexibleBody{wall(0.3)});
  auto b = d.add("b", FlexibleBody{wall(0.3, InPlane::rigid)});
  CHECK(says(error_of([&] { weld(a.line("left"), b.line("right"), fold(1)); }), Code::size,
             {"a.left", "b.right", "x2", "Plate::in_plane"}));
  CHECK(error_of([&] { weld(a.line("left"), b.line("right"), fold(pi / 2)); }).mistakes().empty());
}
