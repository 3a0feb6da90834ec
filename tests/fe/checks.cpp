#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/names.hpp"

/// The checks of modal data name the fault and its place.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using fe_test::relative;

namespace {

Beam boom() {
  return {.length = 2.0,
          .section = rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = 6};
}

MatrixXd rounded(const MatrixXd& A, double digits) {
  return A.unaryExpr([digits](double x) {
    if (x == 0) return x;
    const double unit = std::pow(10, std::floor(std::log10(std::abs(x))) + 1 - digits);
    return std::round(x / unit) * unit;
  });
}

}  // namespace

TEST_CASE("mass properties of a rigid body come back") {
  const Matrix3d I = (Matrix3d() << 3, 0.2, -0.1, 0.2, 4, 0.3, -0.1, 0.3, 5).finished();
  const Vector3d centre(0.4, -0.7, 1.1);
  const MassProperties m = mass_properties(rigid_mass(12, I, -centre));
  CHECK(m.mass == Vector3d(12, 12, 12));
  CHECK((m.centre - centre).norm() <= 1e-15);
  CHECK((m.inertia - I).cwiseAbs().maxCoeff() <= 1e-14);
  CHECK(m.misfit <= 1e-15);
  Matrix6 D = rigid_mass(12, I, -centre);
  D(0, 0) *= 0.9;  // a program that neglects the mass at the clamp
  CHECK(mass_properties(D).misfit > 0.03);
  CHECK(mass_properties(Matrix6::Zero()).misfit == 0);
}

TEST_CASE("residual mass of all modes is M_rr - M_rf M_ff^-1 M_fr") {
  const fe::Mesh mesh = beam_mesh(boom());
  const MatrixXd R = fe::rigid_motions(mesh, Vector3d::Zero());
  const Index n = mesh.M.rows() - 6;
  const MatrixXd M_rf = R.transpose() * mesh.M.rightCols(n), M_ff = mesh.M.bottomRightCorner(n, n);
  const Matrix6 expected = R.transpose() * mesh.M * R - M_rf * M_ff.ldlt().solve(M_rf.transpose());
  const ResidualMass r = residual_mass(modal_data(boom()));
  const Eigen::Array<double, 6, 1> scale = expected.diagonal().array().sqrt();
  CHECK(((r.D_P0 - expected).array().abs() / (scale.matrix() * scale.matrix().transpose()).array())
            .maxCoeff() <= 1e-9);
  CHECK(r.verdict == Definiteness::definite);
}

TEST_CASE("residual mass: singular and negative to the data's digits") {
  ModalData data = modal_data(boom());
  const double left = residual_mass(data).D_P0(0, 0);
  // One mode more with all the residual mass along x: exactly, or too much.
  const auto with_mode_taking = [&](double mass, double digits) {
    ModalData more = data;
    more.L_P.conservativeResize(data.L_P.rows() + 1, Eigen::NoChange);
    more.L_P.bottomRows(1).setZero();
    more.L_P(data.L_P.rows(), 0) = std::sqrt(mass);
    more.digits = digits;
    return residual_mass(more);
  };
  const double total = data.D_P(0, 0);
  CHECK(with_mode_taking(0.9 * left, 15).verdict == Definiteness::definite);
  const ResidualMass negative = with_mode_taking(left + 1e-5 * total, 15);
  CHECK(negative.verdict == Definiteness::indefinite);
  CHECK(relative(negative.smallest, -1e-5) <= 1e-6);
  CHECK(negative.component == 0);
  CHECK(with_mode_taking(left + 1e-8 * total, 7).verdict == Definiteness::singular);
  CHECK(with_mode_taking(left + 1e-4 * total, 7).verdict == Definiteness::indefinite);
  ModalReport report = modal_report(data);
  report.residual = negative;
  CHECK(titop_test::has_line(to_string(report), {"D_P0", "x", "-1e-05"}));
}

TEST_CASE("verdict does not depend on units; a direction without inertia is singular") {
  ModalData data = modal_data(boom());
  const ResidualMass before = residual_mass(data);
  const Vector6 units = (Vector6() << 1, 1, 1, 1e3, 1e3, 1e3).finished();  // m to mm
  data.L_P = data.L_P * units.asDiagonal();
  data.D_P = units.asDiagonal() * data.D_P * units.asDiagonal();
  CHECK(relative(residual_mass(data).smallest, before.smallest) <= 1e-6);
  CHECK(residual_mass(data).component == before.component);
  data.D_P.row(3).setZero();
  data.D_P.col(3).setZero();
  data.L_P.col(3).setZero();
  const ResidualMass r = residual_mass(data);
  CHECK(r.verdict == Definiteness::singular);
  CHECK(r.component == 3);
  ModalReport report = modal_report(data);
  CHECK(titop_test::has_line(to_string(report), {"D_P0", "1e-14", "rx"}));
}

TEST_CASE("rank of Phi_C: which degrees of freedom cannot be driven") {
  Beam beam = boom();
  CHECK(modal_report(modal_data(beam)).children[0].rank == 6);
  beam.modes.kept = 4;  // two bendings in each plane, neither axial nor torsion
  const ModalData data = modal_data(beam);
  ChildRank c = child_rank(data, data.children[0]);
  CHECK(c.rank == 4);
  CHECK(c.blocked == std::vector<std::string>{"x", "rx"});
  beam.modes.kept = 2;  // one in each: tip turns as it moves, by 1.377 / L
  const ModalData two = modal_data(beam);
  c = child_rank(two, two.children[0]);
  CHECK(c.rank == 2);
  CHECK(c.condition < 1.5);
  REQUIRE(c.blocked.size() == 4);
  CHECK(c.blocked[0] == "x");
  CHECK(c.blocked[1] == "rx");
  const std::vector<std::string> rest(c.blocked.begin() + 2, c.blocked.end());
  CHECK((rest == std::vector<std::string>{"y - 1.45 rz", "z + 1.45 ry"} ||
         rest == std::vector<std::string>{"z + 1.45 ry", "y - 1.45 rz"}));
  beam.modes.kept = 0;
  const ModalData none = modal_data(beam);
  c = child_rank(none, none.children[0]);
  CHECK(c.rank == 0);
  CHECK(c.blocked.size() == 6);
  CHECK(titop_test::has_line(to_string(modal_report(two)), {"C", "rank 2"}));
}

TEST_CASE("combinations that cannot be driven are told apart, however the modes mix them") {
  ModalData data = modal_data(boom());
  data.children[0].PC = Vector3d(1, 0, 0);
  // Three motions: x with 2 rx, y with 0.8 rz, z with -0.5 ry; the modes are combinations of them.
  MatrixXd motions = MatrixXd::Zero(6, 3);
  motions(0, 0) = 1;
  motions(3, 0) = 2;
  motions(1, 1) = 1;
  motions(5, 1) = 0.8;
  motions(2, 2) = 1;
  motions(4, 2) = -0.5;
  const Matrix3d mixed = (Matrix3d() << 1, 2, -1, 3, 1, 1, 0.5, -1, 2).finished();
  data.children[0].Phi_C = motions * mixed;
  ChildRank c = child_rank(data, data.children[0]);
  CHECK(c.rank == 3);
  std::sort(c.blocked.begin(), c.blocked.end());
  CHECK(c.blocked == std::vector<std::string>{"x - 0.5 rx", "y - 1.25 rz", "z + 2 ry"});
  // Two motions in y, z, ry, rz: of the plane of combinations at rest, two with three terms each.
  motions.setZero();
  motions.col(0) << 0, 1, 0, 0, 1, 1;
  motions.col(1) << 0, 0, 1, 0, 1, -2;
  ModalData plane = data;
  plane.children[0].Phi_C = motions * mixed;
  c = child_rank(plane, plane.children[0]);
  CHECK(c.rank == 2);
  REQUIRE(c.blocked.size() == 4);
  CHECK(c.blocked[0] == "x");
  CHECK(c.blocked[1] == "rx");
  for (const std::size_t k : {2u, 3u}) {
    INFO(c.blocked[k]);
    const auto terms = 1 + std::count(c.blocked[k].begin(), c.blocked[k].end(), '+') +
                       std::count(c.blocked[k].begin(), c.blocked[k].end(), '-');
    CHECK(terms == 3);
  }
  // Rotations only, displacements of rounding: they are not taken for motions of their own scale.
  data.children[0].Phi_C.topRows(3) *= 1e-17;
  c = child_rank(data, data.children[0]);
  CHECK(c.rank == 3);
  CHECK(c.blocked == std::vector<std::string>{"x", "y", "z"});
}

TEST_CASE("effective masses: textbook's fractions, sums with the residual mass to one") {
  Beam beam = boom();
  beam.elements = 30;
  beam.modes.kept = 40;
  const ModalData data = modal_data(beam);
  const EffectiveMass e = effective_mass(data);
  // [Blevins 1979]: 61.31 %, 18.83 % of a cantilever's mass; a bar's 8 / pi^2.
  CHECK(std::abs(e.fraction(0, 2) - 0.6131) <= 2e-4);
  CHECK(std::abs(e.fraction(1, 1) - 0.6131) <= 2e-4);
  CHECK(std::abs(e.fraction.col(0).maxCoeff() - 8 / (std::numbers::pi * std::numbers::pi)) <= 1e-3);
  const Matrix6 D_P0 = residual_mass(data).D_P0;
  for (int j = 0; j < 6; ++j)
    CHECK(std::abs(e.total(j) + D_P0(j, j) / data.D_P(j, j) - 1) <= 1e-14);
  CHECK(e.total.maxCoeff() < 1);
}

TEST_CASE("digits of a file are told from contradictions") {
  // Every mode of a body whose clamped point has no mass leaves nothing: D_P0 = 0 but for the
  // digits.
  ModalData data = modal_data(boom());
  data.D_P -= residual_mass(data).D_P0;
  ModalData seven = data;
  seven.L_P = rounded(data.L_P, 7);
  seven.D_P = rounded(data.D_P, 7);
  seven.digits = 7;
  const ResidualMass r = residual_mass(seven);
  CHECK(r.verdict == Definiteness::singular);
  CHECK(std::abs(r.smallest) > 1e-9);
  seven.digits = 15;  // the same numbers, claimed exact
  CHECK(residual_mass(seven).verdict != Definiteness::singular);
}
