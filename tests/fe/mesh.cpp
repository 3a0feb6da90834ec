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
#include "dynamics.hpp"
#include "support/refused.hpp"

/// Meshes that are wrong, that move without stiffness, and that have massless degrees of freedom.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::message_of;

namespace {

fe::Mesh boom() {
  return beam_mesh({.length = 2.0,
                    .section = rectangle(0.06, 0.04),
                    .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                    .elements = 4});
}

/// Masses at the points only, without inertia, as bar elements of FE programs have by default.
fe::Mesh lumped() {
  fe::Mesh mesh = boom();
  mesh.M.setZero();
  for (Index i = 0; i < mesh.M.rows(); ++i)
    if (i % 6 < 3) mesh.M(i, i) = 3.0 + 0.1 * double(i / 6);
  return mesh;
}

bool contains(const std::string& text, const std::string& part) {
  INFO(text);
  CHECK(text.find(part) != std::string::npos);
  return text.find(part) != std::string::npos;
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
  fe::Mesh mesh = boom();
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
  fe::Mesh mesh = boom();
  mesh.K(7, 2) += 1;
  contains(message_of([&] { check(mesh); }), "error[bad-value]: K of mesh beam is not symmetric: ");
  contains(message_of([&] { check(mesh); }), "at (1.y, P.z)");
  mesh = boom();
  mesh.M.conservativeResize(29, 30);
  contains(message_of([&] { check(mesh); }),
           "error[size]: M of mesh beam is 29 x 30, it has 30 degrees of freedom");
  mesh = boom();
  mesh.M(3, 3) = std::numeric_limits<double>::infinity();
  mesh.points[1].position.y() = std::numeric_limits<double>::quiet_NaN();
  const std::string text = message_of([&] { check(mesh); });
  contains(text, "error[not-finite]: M(P.rx, P.rx) of mesh beam is not finite");
  contains(text, "error[not-finite]: the position of point 1 of mesh beam is not finite");
  mesh = boom();
  mesh.points[1].name = "C";
  mesh.dofs[8] = mesh.dofs[9];
  contains(message_of([&] { check(mesh); }),
           "error[duplicate-name]: mesh beam has two points or interfaces C");
  contains(message_of([&] { check(mesh); }), "error[duplicate-name]: mesh beam has two rows C.rx");
  mesh = boom();
  mesh.dofs[8] = {9, 2};
  mesh.dofs[9].component = 7;
  mesh.interfaces[0].point = 5;
  contains(message_of([&] { check(mesh); }), "row 8 of mesh beam is component 2 of point 9");
  contains(message_of([&] { check(mesh); }), "row 9 of mesh beam is component 7 of point 1");
  contains(message_of([&] { check(mesh); }), "interface P of mesh beam is point 5, there are 5");
}

TEST_CASE("names that are not there, or twice, or without six degrees of freedom") {
  fe::Mesh mesh = boom();
  CHECK(message_of([&] { fe::modal_data(mesh, "P", {"D"}); }) ==
        "error[unknown-name]: mesh beam has no point D\n  its interfaces are P, C");
  CHECK(message_of([&] { fe::modal_data(mesh, "Q", {"C"}); }).starts_with("error[unknown-name]"));
  CHECK(message_of([&] {
          fe::modal_data(mesh, "P", {"C"}, {.kept = 2, .residual = {"E"}});
        }).starts_with("error[unknown-name]"));
  CHECK(message_of([&] {
          fe::modal_data(mesh, "P", {"C", "1", "C"});
        }).starts_with("error[duplicate-name]: child C of mesh beam is named twice\n  "));
  CHECK(message_of([&] {
          fe::modal_data(mesh, "P", {"C"}, {.kept = 25});
        }).starts_with("error[bad-value]: 25 modes asked of mesh beam, which has 24\n  "));
  CHECK(message_of([&] {
          fe::modal_data(mesh, "P", {"C"}, {.kept = -1});
        }).starts_with("error[bad-value]"));
  mesh.dofs[27].point = 3;  // C loses rx, its neighbour has it twice: take another name for the row
  mesh.points.push_back({"x", Vector3d(9, 0, 0)});
  mesh.dofs[27].point = 5;
  contains(message_of([&] { fe::modal_data(mesh, "P", {"C"}); }),
           "error[bad-modes]: point C of mesh beam cannot be an interface: it has no degree of "
           "freedom rx");
}

TEST_CASE("a mechanism is named") {
  fe::Mesh mesh = boom();
  mesh.K.row(15).setZero();  // torsion of point 2
  mesh.K.col(15).setZero();
  contains(message_of([&] { fe::modal_data(mesh, "P", {"C"}); }),
           "error[bad-modes]: mesh beam clamped at its parent moves without stiffness at 2.rx");
  // Cut in the middle: the outer half is loose, K is singular only up to rounding.
  mesh = boom();
  const fe::Mesh whole = boom();
  mesh.K.block(12, 18, 6, 6).setZero();
  mesh.K.block(18, 12, 6, 6).setZero();
  mesh.K.block(12, 12, 6, 6) = whole.K.block(24, 24, 6, 6);
  mesh.K.block(18, 18, 6, 6) = whole.K.block(0, 0, 6, 6);
  for (const fe::ModeOptions& options :
       {fe::ModeOptions{}, fe::ModeOptions{.kept = 3}, fe::ModeOptions{.kept = 0}}) {
    const std::string text = message_of([&] { fe::modal_data(mesh, "P", {"C"}, options); });
    contains(text, "error[bad-modes]: mesh beam clamped at its parent moves without stiffness at ");
    CHECK((text.find("at C.") != std::string::npos || text.find("at 3.") != std::string::npos));
  }
  // The same if rounding has made K definite: energy of a rigid motion within its own rounding.
  mesh.K.diagonal() *= 1 + 4e-15;
  REQUIRE(weak_pivot(mesh.K.bottomRightCorner(24, 24)) == -1);
  for (const fe::ModeOptions& options : {fe::ModeOptions{}, fe::ModeOptions{.kept = 3}}) {
    const std::string text = message_of([&] { fe::modal_data(mesh, "P", {"C"}, options); });
    contains(text, "error[bad-modes]: mesh beam clamped at its parent moves without stiffness at ");
    CHECK((text.find("at C.") != std::string::npos || text.find("at 3.") != std::string::npos));
  }
}

TEST_CASE("a negative mass is named") {
  fe::Mesh mesh = boom();
  mesh.M(14, 14) = -1;
  contains(message_of([&] { fe::modal_data(mesh, "P", {"C"}); }),
           "error[bad-modes]: the mass matrix of mesh beam is not semidefinite: negative at 2.z");
}

TEST_CASE("massless rotations: refused where a port loads them, condensed elsewhere") {
  fe::Mesh mesh = lumped();
  CHECK(
      message_of([&] { fe::modal_data(mesh, "P", {"C"}); }) ==
      "error[bad-modes]: mesh beam has no mass at C.rx, C.ry, C.rz: a wrench there gives no "
      "finite acceleration\n"
      "  keep a number of modes, with residual vectors at that child (kept, residual), or give the "
      "node some inertia");
  CHECK(fe::modal_data(mesh, "P", {}).omega.size() == 12);
  CHECK(transfer_error(mesh, {}) <= 1e-12);
  for (const Index i : {27, 28, 29}) mesh.M(i, i) = 0.02;  // a fitting at C
  CHECK(fe::modal_data(mesh, "P", {"C"}).omega.size() == 15);
  CHECK(transfer_error(mesh, {"C"}) <= 1e-12);
}

TEST_CASE("a mass beside its node: singular without a zero on the diagonal") {
  fe::Mesh mesh = boom();
  for (const std::size_t point : {1u, 2u, 3u}) {
    const auto first = static_cast<Index>(6 * point);
    mesh.M.middleRows(first, 6).setZero();
    mesh.M.middleCols(first, 6).setZero();
    mesh.M.block(first, first, 6, 6) = rigid_mass(2, Matrix3d::Zero(), Vector3d(0.1, 0.2, -0.3));
  }
  CHECK(fe::modal_data(mesh, "P", {"C"}).omega.size() == 6 + 3 * 3);
  CHECK(transfer_error(mesh, {"C"}) <= 1e-12);
  // The node turns about the mass: without inertia, and not only in rotations.
  contains(message_of([&] { fe::modal_data(mesh, "P", {"2"}); }),
           "has no mass at 2.x, 2.y, 2.z, 2.rx");
}

TEST_CASE("massless rotations with few modes and residual vectors") {
  const fe::Mesh mesh = lumped();
  const ModalData all = fe::modal_data(mesh, "P", {});
  const ModalData few = fe::modal_data(mesh, "P", {"C"}, {.kept = 4, .residual = {"C"}});
  for (Index k = 0; k < 4; ++k) CHECK(fe_test::relative(few.omega(k), all.omega(k)) <= 1e-12);
  CHECK(message_of([&] { fe::modal_data(mesh, "P", {"C"}, {.kept = 13}); })
            .starts_with(
                "error[bad-value]: 13 modes asked, 12 of 24 can be told from infinite ones\n  "));
}

TEST_CASE("a child at the parent's own place does not move with the modes") {
  const ModalData data = fe::modal_data(boom(), "P", {"P", "C"});
  CHECK(data.children[0].Phi_C.isZero(0));
  CHECK(data.children[0].PC.isZero(0));
}
