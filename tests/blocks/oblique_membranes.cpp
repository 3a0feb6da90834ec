#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <vector>

#include "support/transfer_error.hpp"

/// Two membranes welded at any angle, against their meshes assembled by hand: equal displacements,
/// and rotation about the edge, of both edges at some places.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using std::numbers::pi;
using Complex = std::complex<double>;

namespace {

/// A sheet with the line "fold" at this edge.
fe::Mesh sheet(double a, int along_x, const std::string& edge, bool restricted) {
  const fe::Mesh mesh = plate_mesh({.a = a,
                                    .b = 0.6,
                                    .thickness = 0.004,
                                    .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                    .elements = {along_x, 4},
                                    .in_plane = InPlane::membrane});
  const fe::NodeSet line = fe::edge(mesh, edge);
  return fe::with_interface(
      mesh, "fold",
      restricted ? fe::shapes(line, fe::legendre(4)) : fe::moments(line, fe::legendre(4)));
}

fe::Mesh inner(bool restricted) {
  const fe::Mesh mesh = sheet(0.5, 2, "x1", restricted);
  return fe::with_interface(mesh, "root", fe::rigid(fe::segment(mesh, "x0", 0, 0.5)));
}
fe::Mesh outer(bool restricted) {
  const fe::Mesh mesh = sheet(0.4, 2, "x0", restricted);
  return fe::with_interface(mesh, "tip", fe::average(fe::segment(mesh, "x1", 0.5, 1)));
}

std::vector<Index> rows_of(const fe::Mesh& mesh, const std::string& name) {
  std::vector<Index> rows;
  for (const Index row : fe::interface_rows(mesh, name)) rows.push_back(row);
  for (const fe::MeshLine& line : mesh.lines)
    if (line.name == name)
      for (const std::size_t point : line.points)
        for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
          if (mesh.dofs[i].point == point) rows.push_back(static_cast<Index>(i));
  return rows;
}

/// Displacement, and rotation about y times `turn`, of the edge along y at places from -1 to 1 (or
/// from 1 to -1), per coordinate of the line.
MatrixXd motion(const fe::MeshLine& line, double turn) {
  constexpr int kPlaces = 6;
  MatrixXd E = MatrixXd::Zero(4 * kPlaces, 6 + static_cast<Index>(line.shapes.size()));
  for (int i = 0; i < kPlaces; ++i) {
    const double s = turn * (-1 + 2.0 * i / (kPlaces - 1));
    const Vector3d r(0, s * line.length / 2, 0);
    E.block<3, 3>(4 * i, 0).setIdentity();
    for (int c = 0; c < 3; ++c) E.block<3, 1>(4 * i, 3 + c) = Vector3d::Unit(c).cross(r);
    E(4 * i + 3, 4) = turn;
    for (std::size_t k = 0; k < line.shapes.size(); ++k) {
      const auto [component, degree] = line.shapes[k];
      const double p = std::legendre(static_cast<unsigned>(degree), s);
      if (component < 3)
        E(4 * i + component, 6 + static_cast<Index>(k)) = p;
      else
        E(4 * i + 3, 6 + static_cast<Index>(k)) = turn * p;
    }
  }
  return E;
}

/// s^2 (s^2 M + K)^-1 at the tip of b, with the root of a held; T: of b to a, `turn` -1 if it
/// reverses y.
std::vector<MatrixXcd> by_hand(const fe::Mesh& a, const fe::Mesh& b, const Matrix3d& T, double turn,
                               const std::vector<Complex>& points) {
  MatrixXd E_b = motion(b.lines.at(0), turn);
  for (Index i = 0; i < E_b.rows(); i += 4) E_b.middleRows(i, 3) = T * E_b.middleRows(i, 3);
  const MatrixXd E_a = motion(a.lines.at(0), 1),
                 follow = E_b.colPivHouseholderQr().solve(E_a);  // b's coordinates by a's
  REQUIRE((E_b * follow - E_a).norm() <= 1e-12 * E_a.norm());
  const std::vector<Index> fold_a = rows_of(a, "fold"), fold_b = rows_of(b, "fold"),
                           root = rows_of(a, "root"), tip = rows_of(b, "tip");
  const Index n = a.M.rows(), count = n + b.M.rows() - static_cast<Index>(fold_b.size());
  MatrixXd of_b = MatrixXd::Zero(b.M.rows(), count), at_tip(6, count);
  of_b(fold_b, fold_a) = follow;
  Index column = n;
  for (Index i = 0; i < b.M.rows(); ++i)
    if (std::ranges::find(fold_b, i) == fold_b.end()) of_b(i, column++) = 1;
  std::vector<Index> free;
  for (Index i = 0; i < count; ++i)
    if (std::ranges::find(root, i) == root.end()) free.push_back(i);
  const auto assembled = [&](const MatrixXd& A, const MatrixXd& B) {
    MatrixXd S = of_b.transpose() * B * of_b;
    S.topLeftCorner(n, n) += A;
    return MatrixXd(S(free, free));
  };
  const MatrixXd M = assembled(a.M, b.M), K = assembled(a.K, b.K);
  const MatrixXcd R = of_b(tip, free).cast<Complex>();
  std::vector<MatrixXcd> result;
  for (const Complex s : points)
    result.push_back(s * s * R *
                     Eigen::PartialPivLU<MatrixXcd>(s * s * M + K).solve(R.transpose()));
  return result;
}

}  // namespace

TEST_CASE("membranes welded at any angle, and turned end for end") {
  const std::vector<Complex> points = {{0, 20}, {3, 150}, {40, 900}, {200, 0}};
  for (const bool restricted : {true, false}) {
    const fe::Mesh a = inner(restricted), b = outer(restricted);
    const FlexibleBody first{fe::modal_data(a, "root", {"fold"})},
        second{fe::modal_data(b, "fold", {"tip"})};
    for (const double angle : {0.0, 0.4, pi / 2, -2.0})
      for (const bool reversed : {false, true}) {
        const Matrix3d fold = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix(),
                       half = Eigen::AngleAxisd(pi, Vector3d::UnitZ()).toRotationMatrix(),
                       T = reversed ? Matrix3d(fold * half) : fold;
        Diagram d{"fold"};
        auto inside = d.add("a", first), outside = d.add("b", second);
        ground(inside);
        weld(outside.line("fold"), inside.line("fold"), Rotation::matrix(T));
        outside.child("tip").force += d.input("F", 6);
        d.output("a", 6) = outside.child("tip").accel;
        const System system = compile(d);
        std::vector<MatrixXcd> found;
        for (const Complex s : points) found.push_back(system.transfer(s));
        INFO("restricted ", restricted, ", angle ", angle, ", reversed ", reversed);
        CHECK(titop_test::transfer_error(found, by_hand(a, b, T, reversed ? -1 : 1, points), {3, 3},
                                         {3, 3}) <= 1e-9);
      }
  }
}
