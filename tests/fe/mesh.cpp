#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "../../examples/by_hand/by_hand.hpp"
#include "boom.hpp"
#include "dynamics.hpp"
#include "support/mistakes.hpp"

/// Meshes that are wrong, that move without stiffness, and that have massless degrees of freedom.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::boom;
using titop_test::error_of;
using titop_test::has_name;
using titop_test::has_names;
using titop_test::says;

namespace {

/// Masses at the points only, without inertia, as bar elements of FE programs have by default.
fe::Mesh lumped() {
  fe::Mesh mesh = boom(4);
  mesh.M.setZero();
  for (Index i = 0; i < mesh.M.rows(); ++i)
    if (i % 6 < 3) mesh.M(i, i) = 3.0 + 0.1 * double(i / 6);
  return mesh;
}

double transfer_error(const fe::Mesh& mesh, const std::vector<std::string>& children) {
  const ModalData data = fe::modal_data(mesh, "P", children);
  std::vector<Eigen::MatrixXcd> modal, direct;
  for (const double s : {0.3, 1.7, 11.0, 200.0}) {
    const fe_test::Complex at(0.2 * s * data.omega(0), s * data.omega(0));
    modal.push_back(fe_test::modal_transfer(data, at));
    direct.push_back(fe_test::direct_transfer<long double>(mesh, "P", children, at));
  }
  return by_hand::transfer_error(modal, direct, 3, 3);
}

}  // namespace

TEST_CASE("rigid motions carry points by rotation about P") {
  fe::Mesh mesh = boom(4);
  mesh.points[2].position = Vector3d(1, 2, 3);
  const MatrixXd R = fe::rigid_motions(mesh, Vector3d(1, 1, 1));
  // P turns by 1 rad/s about x: the point at (0, 1, 2) from it moves by x cross that.
  const Vector3d moved = Vector3d(1, 0, 0).cross(Vector3d(0, 1, 2));
  CHECK((R.block<3, 1>(12, 3) - moved).norm() == 0);
  CHECK(R.block<3, 3>(15, 3) == Matrix3d::Identity());
  CHECK(R.block<3, 3>(12, 0) == Matrix3d::Identity());
  CHECK(R.block<3, 3>(15, 0).isZero(0));
}

TEST_CASE("a mesh that contradicts itself") {
  fe::Mesh mesh = boom(4);
  mesh.K(7, 2) += 1;
  CHECK(says(error_of([&] { check(mesh); }), Code::bad_value, {"K", "beam", "(1.y, P.z)"}));
  mesh = boom(4);
  mesh.M.conservativeResize(29, 30);
  CHECK(says(error_of([&] { check(mesh); }), Code::size, {"M", "beam", "29 x 30", "30"}));
  mesh = boom(4);
  mesh.M(3, 3) = std::numeric_limits<double>::infinity();
  mesh.points[1].position.y() = std::numeric_limits<double>::quiet_NaN();
  const Error infinite = error_of([&] { check(mesh); });
  CHECK(says(infinite, Code::not_finite, {"M(P.rx, P.rx)", "beam"}));
  CHECK(says(infinite, Code::not_finite, {"point 1", "beam"}));
  mesh = boom(4);
  mesh.points[1].name = "C";
  mesh.dofs[8] = mesh.dofs[9];
  const Error twice = error_of([&] { check(mesh); });
  CHECK(twice.mistakes().size() >= 2);
  CHECK(std::ranges::any_of(twice.mistakes(), [](const Mistake& m) {
    return m.code == Code::duplicate_name && has_names(m.message, {"beam", "C"}) &&
           !has_name(m.message, "C.rx");
  }));
  CHECK(says(twice, Code::duplicate_name, {"beam", "C.rx"}));
  mesh = boom(4);
  mesh.dofs[8] = {9, 2};
  mesh.dofs[9].component = 8;
  mesh.interfaces[0].point = 5;
  const Error outside = error_of([&] { check(mesh); });
  CHECK(says(outside, Code::bad_value, {"row 8", "beam", "component 2", "point 9"}));
  CHECK(says(outside, Code::bad_value, {"row 9", "beam", "component 8", "point 1"}));
  CHECK(says(outside, Code::bad_value, {"P", "beam", "point 5", "5"}));
}

TEST_CASE("names that are not there, or twice, or without six degrees of freedom") {
  fe::Mesh mesh = boom(4);
  const auto refused = [&](const char* parent, const std::vector<std::string>& children,
                           const fe::ModeOptions& options = {}) {
    return error_of([&] { fe::modal_data(mesh, parent, children, options); });
  };
  CHECK(says(refused("P", {"D"}), Code::unknown_name, {"beam", "D", "P, C"}));
  CHECK(says(refused("Q", {"C"}), Code::unknown_name, {"beam", "Q", "P, C"}));
  CHECK(refused("P", {"C"}, {.kept = 2, .residual = {"E"}}).has(Code::unknown_name));
  CHECK(says(refused("P", {"C", "1", "C"}), Code::duplicate_name, {"C", "beam"}));
  CHECK(says(refused("P", {"C"}, {.kept = 25}), Code::bad_value, {"25", "beam", "24"}));
  CHECK(refused("P", {"C"}, {.kept = -1}).has(Code::bad_value));
  mesh.dofs[27].point = 3;  // C loses rx, its neighbour has it twice: take another name for the row
  mesh.points.push_back({"x", Vector3d(9, 0, 0)});
  mesh.dofs[27].point = 5;
  CHECK(says(refused("P", {"C"}), Code::bad_modes, {"C", "beam", "rx"}));
}

TEST_CASE("a mechanism is named") {
  fe::Mesh mesh = boom(4);
  mesh.K.row(15).setZero();  // torsion of point 2
  mesh.K.col(15).setZero();
  CHECK(
      says(error_of([&] { fe::modal_data(mesh, "P", {"C"}); }), Code::bad_modes, {"beam", "2.rx"}));
  // Cut in the middle: the outer half is loose, K is singular only up to rounding.
  mesh = boom(4);
  const fe::Mesh whole = boom(4);
  mesh.K.block(12, 18, 6, 6).setZero();
  mesh.K.block(18, 12, 6, 6).setZero();
  mesh.K.block(12, 12, 6, 6) = whole.K.block(24, 24, 6, 6);
  mesh.K.block(18, 18, 6, 6) = whole.K.block(0, 0, 6, 6);
  for (const fe::ModeOptions& options :
       {fe::ModeOptions{}, fe::ModeOptions{.kept = 3}, fe::ModeOptions{.kept = 0}}) {
    const Error loose = error_of([&] { fe::modal_data(mesh, "P", {"C"}, options); });
    CHECK((says(loose, Code::bad_modes, {"beam", "C."}) ||
           says(loose, Code::bad_modes, {"beam", "3."})));
  }
  // The same if rounding has made K definite: energy of a rigid motion within its own rounding.
  mesh.K.diagonal() *= 1 + 4e-15;
  REQUIRE(weak_pivot(mesh.K.bottomRightCorner(24, 24)) == -1);
  for (const fe::ModeOptions& options : {fe::ModeOptions{}, fe::ModeOptions{.kept = 3}}) {
    const Error loose = error_of([&] { fe::modal_data(mesh, "P", {"C"}, options); });
    CHECK((says(loose, Code::bad_modes, {"beam", "C."}) ||
           says(loose, Code::bad_modes, {"beam", "3."})));
  }
}

TEST_CASE("a negative mass is named") {
  fe::Mesh mesh = boom(4);
  mesh.M(14, 14) = -1;
  CHECK(says(error_of([&] { fe::modal_data(mesh, "P", {"C"}); }), Code::bad_modes,
             {"beam", "2.z", "Mesh::digits"}));
}

TEST_CASE("massless rotations: refused where a port loads them, condensed elsewhere") {
  fe::Mesh mesh = lumped();
  CHECK(says(error_of([&] { fe::modal_data(mesh, "P", {"C"}); }), Code::bad_modes,
             {"beam", "C.rx, C.ry, C.rz", "kept, residual"}));
  CHECK(fe::modal_data(mesh, "P", {}).omega.size() == 12);
  CHECK(transfer_error(mesh, {}) <= 1e-12);
  for (const Index i : {27, 28, 29}) mesh.M(i, i) = 0.02;  // a fitting at C
  CHECK(fe::modal_data(mesh, "P", {"C"}).omega.size() == 15);
  CHECK(transfer_error(mesh, {"C"}) <= 1e-12);
}

TEST_CASE("a mass beside its node: singular without a zero on the diagonal") {
  fe::Mesh mesh = boom(4);
  for (const std::size_t point : {1u, 2u, 3u}) {
    const auto first = static_cast<Index>(6 * point);
    mesh.M.middleRows(first, 6).setZero();
    mesh.M.middleCols(first, 6).setZero();
    mesh.M.block(first, first, 6, 6) = rigid_mass(2, Matrix3d::Zero(), Vector3d(0.1, 0.2, -0.3));
  }
  CHECK(fe::modal_data(mesh, "P", {"C"}).omega.size() == 6 + 3 * 3);
  CHECK(transfer_error(mesh, {"C"}) <= 1e-12);
  // The node turns about the mass: without inertia, and not only in rotations.
  CHECK(says(error_of([&] { fe::modal_data(mesh, "P", {"2"}); }), Code::bad_modes,
             {"beam", "2.x, 2.y, 2.z, 2.rx"}));
}

TEST_CASE("massless rotations with few modes and residual vectors") {
  const fe::Mesh mesh = lumped();
  const ModalData all = fe::modal_data(mesh, "P", {});
  const ModalData few = fe::modal_data(mesh, "P", {"C"}, {.kept = 4, .residual = {"C"}});
  for (Index k = 0; k < 4; ++k) CHECK(fe_test::relative(few.omega(k), all.omega(k)) <= 1e-12);
  CHECK(says(error_of([&] { fe::modal_data(mesh, "P", {"C"}, {.kept = 13}); }), Code::bad_value,
             {"13", "12", "24"}));
}

TEST_CASE("a child at the parent's own place does not move with the modes") {
  const ModalData data = fe::modal_data(boom(4), "P", {"P", "C"});
  CHECK(data.children[0].Phi_C.isZero(0));
  CHECK(data.children[0].PC.isZero(0));
}
