#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "support/mistakes.hpp"

/// Nodes by their places: positions of a few digits, nodes at one place or left out of a line, and
/// nodes that have a part of the degrees of freedom of a plate.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Nodes "0", "1", ... with these components each, unit masses and stiffnesses.
fe::Mesh nodes_at(const std::vector<Vector3d>& places, const std::vector<int>& components) {
  fe::Mesh mesh;
  mesh.name = "solid";
  for (std::size_t i = 0; i < places.size(); ++i) {
    mesh.points.push_back({std::to_string(i), places[i]});
    for (const int c : components) mesh.dofs.push_back({i, c});
  }
  const auto n = static_cast<Index>(mesh.dofs.size());
  mesh.M = mesh.K = MatrixXd::Identity(n, n);
  return mesh;
}

const std::vector<int> kDisplacements = {0, 1, 2}, kAll = {0, 1, 2, 3, 4, 5};

Vector3d rounded(const Vector3d& r, double unit) { return (r / unit).array().round() * unit; }

Error refused(const fe::Mesh& mesh, const fe::Coupling& coupling) {
  return error_of([&] { fe::with_interface(mesh, "C", coupling); });
}

}  // namespace

TEST_CASE("nodes on one line, typed with five decimals, do not turn about it") {
  const auto mesh = [](double beside) {
    return nodes_at({{0, 0, 0}, {0.43301, 0.25, beside}, {0.86603, 0.5, 0}, {0.3, -0.5, 0.4}},
                    kDisplacements);
  };
  for (const auto couple : {fe::rigid, static_cast<fe::Coupling (*)(fe::NodeSet)>(fe::average)}) {
    const fe::Mesh straight = mesh(0), bent = mesh(0.01);
    CHECK(says(refused(straight, couple(fe::nodes(straight, {"0", "1", "2"}))), Code::bad_modes,
               {"C", "solid", "rx", "ry"}));
    CHECK(refused(bent, couple(fe::nodes(bent, {"0", "1", "2"}))).mistakes().empty());
  }
  // Nodes with rotations do determine it, in any unit of length.
  fe::Mesh turning = nodes_at({{0, 0, 0}, {1e7, 0, 0}, {2e7, 0, 0}, {0, 1e7, 0}}, kAll);
  CHECK(refused(turning, fe::rigid(fe::nodes(turning, {"0", "1", "2"}))).mistakes().empty());
}

TEST_CASE("the rotation about a line of rounded places is that of the nodes") {
  // Compliance 1 of each row: that of the mean of three rotations is 1/3. From the offsets of the
  // nodes, some 1e-6, it would be 1e11.
  const fe::Mesh mesh =
      nodes_at({{0, 0, 0}, {0.43301, 0.25, 0}, {0.86603, 0.5, 0}, {0.3, -0.5, 0.4}}, kAll);
  const fe::NodeSet line = fe::nodes(mesh, {"0", "1", "2"});
  const fe::Mesh tied = fe::with_interface(mesh, "C", fe::average(line));
  const MatrixXd compliance = solve_definite(tied.K, MatrixXd::Identity(24, 24));
  const Vector3d axis = Vector3d(0.86603, 0.5, 0).normalized();
  std::vector<Index> turning;
  for (const int c : {3, 4, 5})
    turning.push_back(fe::interface_rows(tied, "C")[static_cast<std::size_t>(c)]);
  CHECK(std::abs(axis.dot(MatrixXd(compliance(turning, turning)) * axis) - 1.0 / 3) <= 1e-4);
}

TEST_CASE("places of six digits: segments, boxes and straight edges have all their nodes") {
  std::vector<Vector3d> places;
  for (int i = 0; i <= 7; ++i) places.push_back(rounded(Vector3d(1, 0.3, 0.2) * i / 7, 1e-6));
  const fe::Mesh oblique = nodes_at(places, kDisplacements);
  CHECK(fe::segment(oblique, {0, 0, 0}, {1, 0.3, 0.2}).points.size() == 8);
  CHECK(fe::segment(oblique, {0, 0, 0}, Vector3d(1, 0.3, 0.2) * 3 / 7).points.size() == 4);
  CHECK(fe::box(oblique, Vector3d(1, 0.3, 0.2) * 2 / 7, {1, 1, 1}).points.size() == 6);
  CHECK(fe::box(oblique, {0, 0, 0}, Vector3d(1, 0.3, 0.2) * 2 / 7).points.size() == 3);
  const fe::Mesh edge =
      nodes_at({{0, 0.333333, 0}, {0.5, 0.333334, 0}, {1, 0.333333, 0}, {0, 1, 0}}, kAll);
  const fe::NodeSet line = fe::segment(edge, {0, 1.0 / 3, 0}, {1, 1.0 / 3, 0});
  CHECK(line.points.size() == 3);
  CHECK(fe::with_interface(edge, "e", fe::shapes(line, fe::legendre(3))).lines.size() == 1);
  // With positions to three digits, as of statics.
  fe::Mesh rough = nodes_at({{0, 0.333, 0}, {0.5, 0.334, 0}, {1, 0.333, 0}, {0, 1, 0}}, kAll);
  CHECK(fe::segment(rough, {0, 0.333, 0}, {1, 0.333, 0}).points.size() == 2);
  rough.position_noise = 1e-3;
  CHECK(fe::segment(rough, {0, 0.333, 0}, {1, 0.333, 0}).points.size() == 3);
}

TEST_CASE("a line has all nodes between its ends, and polynomials for those at different places") {
  const fe::Mesh plate = plate_mesh({.a = 1,
                                     .b = 1,
                                     .thickness = 0.01,
                                     .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                     .elements = {2, 4}});
  const fe::NodeSet every_other = fe::nodes(plate, {"0,0", "0,2", "0,4"});
  for (const fe::Coupling& coupling :
       {fe::shapes(every_other, fe::legendre(2)), fe::moments(every_other, fe::legendre(2))})
    CHECK(says(refused(plate, coupling), Code::bad_value, {"0,1", "plate", "fe::segment"}));
  CHECK(refused(plate, fe::rigid(every_other)).mistakes().empty());
  CHECK(refused(plate, fe::shapes(fe::nodes(plate, {"0,1", "0,2", "0,3"}), fe::legendre(2)))
            .mistakes()
            .empty());
  // A second node at the place of one of the line is none between.
  const fe::Mesh doubled = nodes_at({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, kAll);
  const fe::NodeSet line = fe::segment(doubled, {0, 0, 0}, {2, 0, 0});
  REQUIRE(line.points.size() == 4);
  for (const auto couple : {fe::shapes, fe::moments}) {
    CHECK(refused(doubled, couple(line, fe::legendre(3))).mistakes().empty());
    CHECK(says(refused(doubled, couple(line, fe::legendre(4))), Code::bad_value,
               {"4 polynomials", "3 nodes", "places"}));
    CHECK(refused(doubled, couple(fe::nodes(doubled, {"0", "1", "3"}), fe::legendre(3)))
              .mistakes()
              .empty());
  }
}

TEST_CASE("moments that a component of a single node would decide are refused") {
  fe::Mesh beam = beam_mesh({.length = 2,
                             .section = rectangle(0.06, 0.04),
                             .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                             .elements = 4});
  beam.interfaces.clear();
  const fe::NodeSet line = fe::segment(beam, {0.5, 0, 0}, {2, 0, 0});
  CHECK(refused(beam, fe::moments(line, fe::legendre(2))).mistakes().empty());
  std::vector<Index> rows;  // without y of node 2
  for (Index i = 0; i < beam.M.rows(); ++i)
    if (i != 13) rows.push_back(i);
  beam.M = MatrixXd(beam.M(rows, rows)), beam.K = MatrixXd(beam.K(rows, rows));
  beam.dofs.erase(beam.dofs.begin() + 13);
  CHECK(says(refused(beam, fe::moments(line, fe::legendre(2))), Code::bad_modes,
             {"C", "beam", "does not determine"}));
}

TEST_CASE("moments of nodes with displacements along the line beside a plate's functions") {
  // A strip of nodes with x, z, rx, ry, wxy: z and rx have cubic functions, x has none.
  std::vector<Vector3d> places = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {4, 0, 0}};
  fe::Mesh mesh = nodes_at(places, {0, 2, 3, 4, fe::kTwist});
  for (Index i = 0; i < mesh.K.rows(); ++i) mesh.K(i, i) = 1 + double(i);
  const fe::NodeSet line = fe::segment(mesh, {0, 0, 0}, {4, 0, 0});
  const fe::Mesh tied = fe::with_interface(mesh, "e", fe::moments(line, fe::legendre(3)));
  REQUIRE(tied.lines.size() == 1);
  std::vector<std::string> names;
  for (const LineShape& s : tied.lines[0].shapes) names.push_back(to_string(s));
  CHECK(names == std::vector<std::string>{"x1", "x2", "z2", "rx1", "rx2"});
  // Coefficients of P0, P1, P2 of x by the trapezoidal rule, and their compliance.
  MatrixXd V(4, 3), flexibility = MatrixXd::Zero(4, 4);
  for (Index i = 0; i < 4; ++i) {
    const double s = places[static_cast<std::size_t>(i)].x() / 2 - 1;
    V.row(i) << 1, s, (3 * s * s - 1) / 2;
    flexibility(i, i) = 1 / (1 + 5 * double(i));
  }
  const VectorXd weights = (VectorXd(4) << 0.5, 1, 1.5, 1).finished();
  const MatrixXd VW = V.transpose() * weights.asDiagonal();
  const MatrixXd A = solve_definite(VW * V, VW);
  const MatrixXd expected = A * flexibility * A.transpose();
  const MatrixXd compliance = solve_definite(tied.K, MatrixXd::Identity(20, 20));
  std::vector<Index> x = {
      fe::interface_rows(tied, "e", {false, true, false, false, false, true})[0]};
  for (Index i = 0; i < tied.K.rows(); ++i)
    for (const std::size_t k : {0U, 1U})
      if (tied.dofs[static_cast<std::size_t>(i)].point == tied.lines[0].points[k]) x.push_back(i);
  REQUIRE(x.size() == 3);
  CHECK((compliance(x, x) - expected).cwiseAbs().maxCoeff() <= 1e-12 * expected.maxCoeff());
}
