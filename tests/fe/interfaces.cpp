#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/mistakes.hpp"

/// Interfaces of many nodes: frequencies of the same elements in another program, compliances by
/// hand, and the two bounds.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Frequencies of this plate are omega a^2 sqrt(rho h / D), nu = 0.3.
Plate unit_plate(std::array<int, 2> elements, double a = 1, double b = 1) {
  return {.a = a,
          .b = b,
          .thickness = 0.01,
          .material = {.rho = 100},
          .D = PlateStiffness{1, 0.3, 1, 0.35},
          .elements = elements};
}

VectorXd omegas(const fe::Mesh& mesh, const std::string& parent, int count) {
  return fe::modal_data(mesh, parent, {}, {.kept = count}).omega;
}

Index row_of(const fe::Mesh& mesh, const std::string& point, int component) {
  const std::size_t at = fe::find_point(mesh, point);
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i].point == at && mesh.dofs[i].component == component)
      return static_cast<Index>(i);
  return -1;
}

/// Compliance of a child of the body clamped at its parent, by all modes.
MatrixXd compliance(const ModalData& data) {
  const MatrixXd& Phi = data.children.at(0).Phi_C;
  return Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
}

double apart(const MatrixXd& a, const MatrixXd& b) {
  const VectorXd scale =
      b.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 1.0; });
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("plate held along a quarter of an edge: rigid above, average below") {
  // The same elements in another program, 8 x 8; the values of 24 x 24 lie between.
  const fe::Mesh mesh = plate_mesh(unit_plate({8, 8}));
  const fe::NodeSet quarter = fe::segment(mesh, "x0", 0.375, 0.625);
  REQUIRE(quarter.points.size() == 3);
  const VectorXd rigid = omegas(fe::with_interface(mesh, "P", fe::rigid(quarter)), "P", 2);
  CHECK(std::abs(rigid(0) - 2.7511) <= 6e-5);
  CHECK(std::abs(rigid(1) - 5.9959) <= 6e-5);
  const VectorXd average = omegas(fe::with_interface(mesh, "P", fe::average(quarter)), "P", 2);
  CHECK(std::abs(average(0) - 2.6007) <= 6e-5);
  CHECK(std::abs(average(1) - 4.8568) <= 6e-5);
  // 16 x 16: both sides fall towards the limit between them.
  const fe::Mesh fine = plate_mesh(unit_plate({16, 16}));
  const fe::NodeSet five = fe::segment(fine, "x0", 0.375, 0.625);
  const VectorXd above = omegas(fe::with_interface(fine, "P", fe::rigid(five)), "P", 2),
                 under = omegas(fe::with_interface(fine, "P", fe::average(five)), "P", 2);
  CHECK(std::abs(above(0) - 2.70568) <= 1e-5);
  CHECK(std::abs(above(1) - 5.80847) <= 1e-5);
  CHECK(std::abs(under(0) - 2.54040) <= 1e-5);
  CHECK(std::abs(under(1) - 4.69050) <= 1e-5);
}

TEST_CASE("a whole edge that is rigid is the clamped edge") {
  const fe::Mesh mesh = plate_mesh(unit_plate({8, 8}));
  const VectorXd omega =
      omegas(fe::with_interface(mesh, "P", fe::rigid(fe::edge(mesh, "x0"))), "P", 3);
  for (const auto& [k, expected] : {std::pair{0, 3.47201}, {1, 8.50957}, {2, 21.29249}})
    CHECK(relative(omega(k), expected) <= 1.5e-6);
}

TEST_CASE("mass and rigid motion are unchanged, and the interface is at its nodes' centre") {
  const fe::Mesh plain = plate_mesh(unit_plate({4, 4}, 2, 1));
  const MatrixXd R = fe::rigid_motions(plain, Vector3d::Zero());
  const Matrix6 mass = R.transpose() * plain.M * R;
  for (const fe::Coupling& coupling :
       {fe::rigid(fe::edge(plain, "x1")), fe::average(fe::edge(plain, "x1")),
        fe::shapes(fe::edge(plain, "x1"), fe::legendre(3)),
        fe::moments(fe::edge(plain, "x1"), fe::legendre(3)),
        fe::average(fe::box(plain, {1, 0.25, 0}, {2, 0.75, 0}))}) {
    const fe::Mesh mesh = fe::with_interface(plain, "C", coupling);
    const MatrixXd R_tied = fe::rigid_motions(mesh, Vector3d::Zero());
    CHECK((R_tied.transpose() * mesh.M * R_tied - mass).cwiseAbs().maxCoeff() <= 1e-13);
    CHECK(fe::mesh_report(mesh).KR_terms <= 1e-12);
    const ModalData data = fe::modal_data(mesh, "0,2", {"C"});
    const double x = coupling.nodes.points.size() == 9 ? 1.5 : 2;
    CHECK((data.children[0].PC - Vector3d(x, 0, 0)).norm() <= 1e-14);
    CHECK(says(error_of([&] { fe::modal_data(mesh, "4,2", {}); }), Code::bad_modes,
               {"4,2", "z", "belong to the interface C"}));
  }
}

TEST_CASE("average of a plate's edge: compliance by hand, with other weights, too") {
  const fe::Mesh plain = plate_mesh(unit_plate({3, 4}, 1, 0.8));
  const fe::Mesh held = fe::with_interface(plain, "P", fe::rigid(fe::edge(plain, "x0")));
  const fe::NodeSet edge = fe::edge(held, "x1");
  const std::vector<double> lumped = {1, 2, 2, 2, 1}, own = {0.3, 1, 0.2, 2, 0.7};
  for (const auto& weights : {lumped, own}) {
    const fe::Coupling coupling = weights == lumped ? fe::average(edge) : fe::average(edge, own);
    const ModalData data = fe::modal_data(fe::with_interface(held, "C", coupling), "P", {"C"});
    // Mean deflection and slopes: z, rx = slope over y by least squares, ry = mean.
    double sum = 0, first = 0, second = 0;
    for (int j = 0; j <= 4; ++j)
      sum += weights[std::size_t(j)], first += weights[std::size_t(j)] * 0.2 * j;
    const double centre = first / sum;
    for (int j = 0; j <= 4; ++j) second += weights[std::size_t(j)] * std::pow(0.2 * j - centre, 2);
    MatrixXd A = MatrixXd::Zero(6, plain.K.rows());
    for (int j = 0; j <= 4; ++j) {
      const double w = weights[std::size_t(j)];
      const std::string node = "3," + std::to_string(j);
      A(2, row_of(plain, node, 2)) = w / sum;
      A(3, row_of(plain, node, 2)) = w * (0.2 * j - centre) / second;
      A(4, row_of(plain, node, 4)) = w / sum;
    }
    std::vector<Index> free;
    for (Index i = 4 * 5; i < plain.K.rows(); ++i) free.push_back(i);
    const MatrixXd F = A(Eigen::all, free);
    const MatrixXd expected = F * solve_definite(plain.K(free, free), F.transpose());
    CHECK(apart(compliance(data), expected) <= 1e-10);
    CHECK((data.children[0].PC - Vector3d(1, centre - 0.4, 0)).norm() <= 1e-14);
  }
}

TEST_CASE("rigid end of a beam: as if its last element were rigid; average of a node is the node") {
  const Beam beam{.length = 2.0,
                  .section = rectangle(0.06, 0.04),
                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                  .elements = 4};
  const fe::Mesh mesh = beam_mesh(beam);
  // Two nodes, 0.5 m apart: flexible up to 1.5 m, then rigid; the point is at 1.75 m.
  const ModalData data = fe::modal_data(
      fe::with_interface(mesh, "tip", fe::rigid(fe::nodes(mesh, {"3", "4"}))), "P", {"tip"});
  Beam shorter = beam;
  shorter.length = 1.5, shorter.elements = 3;
  const Matrix6 carried = tau(-Vector3d(0.25, 0, 0));
  const MatrixXd expected = carried * compliance(modal_data(shorter)) * carried.transpose();
  CHECK(apart(compliance(data), expected) <= 1e-10);
  for (const fe::Coupling& one :
       {fe::average(fe::nodes(mesh, {"C"})), fe::rigid(fe::nodes(mesh, {"C"}))})
    CHECK(fe::modal_data(fe::with_interface(mesh, "tip", one), "P", {"tip"}).omega ==
          modal_data(beam).omega);
  // Of two nodes on a line of rotations: the rotation about it is their mean.
  const ModalData mean = fe::modal_data(
      fe::with_interface(mesh, "tip", fe::average(fe::nodes(mesh, {"3", "4"}))), "P", {"tip"});
  const double G = 70e9 / 2.66, J = rectangle(0.06, 0.04).J;
  // theta_3 + theta_4 over 2 for half a torque at each: (1.5 + 1.5 + 1.5 + 2) / 4 = 1.625 m.
  CHECK(relative(compliance(mean)(3, 3), 1.625 / (G * J)) <= 1e-10);
}

TEST_CASE("average and rigid cross-section of solid elements: compliance by hand") {
  const fe::Mesh plain =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}});
  const fe::NodeSet ring = fe::box(plain, {0.9, -1, -1}, {0.9, 1, 1});
  REQUIRE(ring.points.size() == 8);
  // Mean displacement, and (sum (r x)'(r x))^-1 sum r x u.
  MatrixXd A = MatrixXd::Zero(6, plain.K.rows());
  Matrix3d inertia = Matrix3d::Zero();
  for (const std::size_t i : ring.points) {
    const Matrix3d r = cross(plain.points[i].position - Vector3d(0.9, 0, 0));
    inertia += r.transpose() * r;
  }
  for (const std::size_t i : ring.points)
    for (int c = 0; c < 3; ++c) {
      const Index row = row_of(plain, plain.points[i].name, c);
      A(c, row) = 1.0 / 8;
      A.col(row).tail<3>() =
          inertia.inverse() * cross(plain.points[i].position - Vector3d(0.9, 0, 0)).col(c);
    }
  std::vector<Index> free;
  for (Index i = 0; i < plain.K.rows(); ++i)
    if (plain.dofs[static_cast<std::size_t>(i)].point != fe::find_point(plain, "P"))
      free.push_back(i);
  const MatrixXd F = A(Eigen::all, free);
  const MatrixXd by_hand = F * solve_definite(plain.K(free, free), F.transpose());
  const auto with = [&](const fe::Coupling& coupling) {
    return compliance(fe::modal_data(fe::with_interface(plain, "ring", coupling), "P", {"ring"}));
  };
  // 14 digits of K leave 9 of its bending stiffness.
  const MatrixXd average = with(fe::average(ring));
  CHECK(apart(average, by_hand) <= 1e-7);
  // A constraint makes it stiffer: less by a semidefinite matrix, a small one.
  const MatrixXd less = average - with(fe::rigid(ring));
  const VectorXd scale = average.diagonal().cwiseSqrt().cwiseInverse();
  CHECK(eigh(scale.asDiagonal() * less * scale.asDiagonal()).lambda(0) >= -1e-7);
  CHECK(less(1, 1) > 0);
  CHECK(less(1, 1) < 0.05 * average(1, 1));
}

TEST_CASE("nodes by name, box, edge, parts of edges and lines") {
  const fe::Mesh mesh = plate_mesh(unit_plate({4, 2}, 2, 1));
  const auto names = [&](const fe::NodeSet& set) {
    std::string all;
    for (const std::size_t i : set.points) all += mesh.points[i].name + " ";
    return all;
  };
  CHECK(names(fe::edge(mesh, "y1")) == "0,2 1,2 2,2 3,2 4,2 ");
  CHECK(fe::edge(mesh, "y1").weights == (VectorXd(5) << 0.25, 0.5, 0.5, 0.5, 0.25).finished());
  CHECK(names(fe::segment(mesh, "y1", 0.25, 0.75)) == "1,2 2,2 3,2 ");
  CHECK(names(fe::segment(mesh, "x0", 0, 0.5)) == "0,0 0,1 ");
  CHECK(names(fe::segment(mesh, {2, 0, 0}, {0, 1, 0})) == "4,0 2,1 0,2 ");
  CHECK(names(fe::box(mesh, {0.4, 0.5, 0}, {1, 1, 0})) == "1,1 1,2 2,1 2,2 ");
  CHECK(names(fe::nodes(mesh, {"3,1", "0,0"})) == "3,1 0,0 ");
  CHECK(
      says(error_of([&] { fe::edge(mesh, "x2"); }), Code::unknown_name, {"plate", "x2", "x0, x1"}));
  // Ends that are no nodes: not the nodes inside, which are less than the segment.
  CHECK(says(error_of([&] { fe::segment(mesh, "y1", 0.3, 0.75); }), Code::bad_value,
             {"y1", "at 0.3", "0.25", "0.5"}));
  CHECK(says(error_of([&] { fe::segment(mesh, "y1", 0.25, 0.6); }), Code::bad_value,
             {"y1", "at 0.6", "0.5", "0.75"}));
  CHECK(says(error_of([&] { fe::segment(mesh, "y1", 0.6, 0.4); }), Code::bad_value, {"0.6"}));
  CHECK(says(error_of([&] {
               fe::box(mesh, {3, 0, 0}, {4, 1, 0});
             }),
             Code::bad_value, {"plate", "3"}));
  CHECK(says(error_of([&] {
               fe::segment(mesh, {3, 0, 0}, {4, 1, 0});
             }),
             Code::bad_value, {"plate"}));
  CHECK(says(error_of([&] { fe::nodes(mesh, {"9,9"}); }), Code::unknown_name, {"9,9"}));
}

TEST_CASE("interfaces that their nodes do not determine are refused") {
  const fe::Mesh plate = plate_mesh(unit_plate({2, 4}));
  const auto refused = [](const fe::Mesh& mesh, const fe::Coupling& coupling) {
    return error_of([&] { fe::with_interface(mesh, "C", coupling); });
  };
  const fe::NodeSet edge = fe::edge(plate, "x1");
  CHECK(refused(plate, fe::shapes(edge, fe::legendre(5))).mistakes().empty());
  for (const fe::Coupling& coupling :
       {fe::shapes(edge, fe::legendre(6)), fe::moments(edge, fe::legendre(6))})
    CHECK(
        says(refused(plate, coupling), Code::bad_value, {"C", "plate", "6", "5 nodes", "edge x1"}));
  CHECK(says(refused(plate, fe::shapes(edge, fe::legendre(1))), Code::bad_value,
             {"1", "legendre(2)"}));
  CHECK(says(refused(plate, fe::shapes(fe::box(plate, {0.5, 0, 0}, {1, 1, 0}), fe::legendre(2))),
             Code::bad_value, {"box", "fe::rigid"}));
  CHECK(says(refused(plate, fe::average(edge, {1, 2})), Code::size, {"2 weights", "5 nodes"}));
  CHECK(says(refused(plate, fe::average(edge, {1, 2, 0, 1, 1})), Code::bad_value, {"weight"}));
  CHECK(says(refused(plate, fe::rigid(fe::nodes(plate, {"0,0", "0,0"}))), Code::bad_value,
             {"twice"}));
  CHECK(says(error_of([&] { fe::with_interface(plate, "1,1", fe::rigid(edge)); }),
             Code::duplicate_name, {"1,1", "plate"}));
  // A corner of two edges belongs to one interface.
  const fe::Mesh one = fe::with_interface(plate, "P", fe::rigid(fe::edge(plate, "y0")));
  CHECK(says(refused(one, fe::average(edge)), Code::bad_modes, {"C", "2,0", "one interface"}));
  CHECK(refused(one, fe::average(fe::segment(one, "x1", 0.25, 1))).mistakes().empty());
}

TEST_CASE("nodes without rotations on one line do not turn about it: the axis is named") {
  // Displacements alone, as of solid elements: bars along x, y and a diagonal.
  for (const auto& [along, axis] :
       {std::pair{Vector3d(1, 0, 0), "rx"}, {Vector3d(0, 0, 2), "rz"}, {Vector3d(1, 1, 0), "rx"}}) {
    fe::Mesh mesh;
    mesh.name = "solid";
    for (std::size_t i = 0; i < 3; ++i) {
      mesh.points.push_back({std::to_string(i), double(i) * along});
      for (int c = 0; c < 3; ++c) mesh.dofs.push_back({i, c});
    }
    mesh.points.push_back({"beside", Vector3d(0.3, -0.5, 0.4)});
    for (int c = 0; c < 3; ++c) mesh.dofs.push_back({3, c});
    mesh.M = MatrixXd::Identity(12, 12), mesh.K = MatrixXd::Zero(12, 12);
    const fe::NodeSet line = fe::nodes(mesh, {"0", "1", "2"});
    for (const fe::Coupling& coupling : {fe::average(line), fe::rigid(line)})
      CHECK(says(error_of([&] { fe::with_interface(mesh, "C", coupling); }), Code::bad_modes,
                 {"C", "solid", axis, "3 nodes by name"}));
    const fe::NodeSet four = fe::nodes(mesh, {"0", "1", "2", "beside"});
    for (const fe::Coupling& coupling : {fe::average(four), fe::rigid(four)})
      CHECK(error_of([&] { fe::with_interface(mesh, "C", coupling); }).mistakes().empty());
  }
}

TEST_CASE("a clamp or a moment at one node of a plate is warned of") {
  const fe::Mesh mesh = plate_mesh(unit_plate({2, 2}));
  const ModalData data = fe::modal_data(mesh, "0,1", {"2,1"});
  REQUIRE(data.warnings.size() == 2);
  CHECK(titop_test::has_names(data.warnings[0], {"0,1", "plate", "clamp", "fe::rigid"}));
  CHECK(titop_test::has_names(data.warnings[1], {"2,1", "plate", "moment", "fe::average"}));
  const fe::Mesh one = fe::with_interface(mesh, "P", fe::rigid(fe::nodes(mesh, {"0,1"})));
  CHECK(fe::modal_data(one, "P", {}).warnings.size() == 1);
  const fe::Mesh edge = fe::with_interface(mesh, "P", fe::average(fe::edge(mesh, "x0")));
  CHECK(fe::modal_data(edge, "P", {}).warnings.empty());
}
