// Matrices of incomplete data: rows without stiffness and mass, planar models, no positions. Small
// files of a beam, whose matrices are known without the file.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/linalg/eigen.hpp>

#include "boom.hpp"
#include "dynamics.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using fe_test::boom;
using fe_test::relative;
using titop_test::check_refused;

namespace {

/// The beam's rows of these components (1 to 6) at grids 1, 2, 3.
fe::GridMatrices rows(const std::vector<int>& components) {
  const fe::Mesh mesh = boom(2);
  fe::GridMatrices m{"beam", {}, {}, {}, 15};
  std::vector<Index> kept;
  for (int grid = 1; grid <= 3; ++grid)
    for (const int c : components) {
      m.dofs.push_back({grid, c});
      kept.push_back(6 * (grid - 1) + c - 1);
    }
  m.K = mesh.K(kept, kept), m.M = mesh.M(kept, kept);
  return m;
}

/// One matrix as DMIG, in fields of 16 columns with ten digits.
std::string dmig(const std::string& name, const std::vector<fe::GridDof>& dofs, const MatrixXd& S) {
  std::string text = fmt::format("DMIG    {:8}       0       6       2       0\n", name);
  for (Index j = 0; j < S.cols(); ++j) {
    const auto& column = dofs[static_cast<std::size_t>(j)];
    text += fmt::format("DMIG*   {:16}{:16}{:16}\n", name, column.grid, column.component);
    for (Index i = 0; i <= j; ++i) {
      const auto& row = dofs[static_cast<std::size_t>(i)];
      text += fmt::format("*       {:16}{:16}{:16.9E}\n", row.grid, row.component, S(i, j));
    }
  }
  return text;
}

fe::GridMatrices through_a_file(const fe::GridMatrices& m) {
  const titop_test::Folder folder;
  folder.write("beam.pch", dmig("KAAX", m.dofs, m.K) + dmig("MAAX", m.dofs, m.M));
  return fe::read_dmig(folder.path / "beam.pch", "KAAX", "MAAX");
}

const std::vector<fe::Grid> kGrids = {
    {1, {0, 0, 0}, {}, "P"}, {2, {1, 0, 0}, {}, ""}, {3, {2, 0, 0}, {}, "C"}};
const std::vector<int> kAll = {1, 2, 3, 4, 5, 6}, kPlanar = {3, 4, 5};

/// Mass matrix of the whole beam about P: a slender rod with the torsional inertia of its section.
Matrix6 rod() {
  const double m = 2700 * 0.06 * 0.04 * 2;
  const double polar = 2700 * 2 * (0.06 * 0.04) * (0.06 * 0.06 + 0.04 * 0.04) / 12;
  return rigid_mass(m, Eigen::Vector3d(polar, m / 3, m / 3).asDiagonal(), {-1, 0, 0});
}

}  // namespace

TEST_CASE("rows without stiffness and mass are named, and can be dropped") {
  fe::GridMatrices m = rows(kAll);
  const fe::GridMatrices whole = m;
  m.dofs.push_back({901, 0}), m.dofs.push_back({902, 0});  // scalar points that no mode took
  for (MatrixXd* S : {&m.K, &m.M}) {
    S->conservativeResize(20, 20);
    S->rightCols(2).setZero(), S->bottomRows(2).setZero();
    S->row(9).setZero(), S->col(9).setZero();  // grid 2, component 4
  }
  check_refused([&] { fe::modal_data(fe::to_mesh(m, kGrids), "P", {"C"}); }, Code::bad_modes,
                {"3 rows", "beam", "2.rx", "scalar 901", "scalar 902", "empty_rows(m)"});
  const std::vector<fe::GridDof> empty = fe::empty_rows(m);
  CHECK(empty == std::vector<fe::GridDof>{{2, 4}, {901, 0}, {902, 0}});
  const fe::GridMatrices rest = fe::without(m, empty);
  REQUIRE(rest.dofs.size() == 17);
  CHECK(rest.dofs[9] == fe::GridDof{2, 5});
  CHECK(rest.K(9, 9) == whole.K(10, 10));
  CHECK(fe::empty_rows(rest).empty());
  check_refused([&] { fe::without(m, {{7, 1}}); }, Code::unknown_name, {"beam", "grid 7"});
  // With all other rows the beam has all its modes again.
  fe::GridMatrices more = whole;
  more.dofs.push_back({901, 0});
  for (MatrixXd* S : {&more.K, &more.M}) {
    S->conservativeResize(19, 19);
    S->rightCols(1).setZero(), S->bottomRows(1).setZero();
  }
  const ModalData data =
      fe::modal_data(fe::to_mesh(fe::without(more, fe::empty_rows(more)), kGrids), "P", {"C"});
  CHECK(data.omega == fe::modal_data(fe::to_mesh(whole, kGrids), "P", {"C"}).omega);
}

TEST_CASE("a planar model is rigid in the other directions, with the mass that is given") {
  const fe::Mesh mesh = fe::to_mesh(through_a_file(rows(kPlanar)), kGrids);
  CHECK(mesh.digits == 10);
  check_refused([&] { fe::modal_data(mesh, "P", {"C"}); }, Code::bad_modes,
                {"P", "beam", "x, y, rz", "ModeOptions::rigid"});
  const ModalData data = fe::modal_data(mesh, "P", {"C"}, {.rigid = rod()});

  const fe::GridMatrices m = rows(kPlanar);  // clamped by hand
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(m.K.bottomRightCorner(6, 6),
                                                                 m.M.bottomRightCorner(6, 6));
  for (Index k = 0; k < 6; ++k)
    CHECK(relative(data.omega(k), std::sqrt(modes.eigenvalues()(k))) <= 1e-8);
  CHECK((data.D_P - rod()).cwiseAbs().maxCoeff() <= 1e-8 * rod().maxCoeff());
  for (const int still : {0, 1, 5}) {
    CHECK(data.L_P.col(still).isZero(0));
    CHECK(data.children[0].Phi_C.row(still).isZero(0));
  }
  CHECK(data.L_P.col(2).norm() > 1);
  // Another mass, centre or inertia than those of M.
  check_refused([&] { fe::modal_data(mesh, "P", {"C"}, {.rigid = Matrix6(10 * rod())}); },
                Code::bad_value, {"ModeOptions::rigid", "z, z", "beam"});
  for (const int turn : {3, 4}) {
    Matrix6 other = rod();
    other(turn, turn) *= 1.01;
    check_refused([&] { fe::modal_data(mesh, "P", {"C"}, {.rigid = other}); }, Code::bad_value,
                  {"ModeOptions::rigid", turn == 3 ? "rx, rx" : "ry, ry"});
  }
  Matrix6 other = rod();
  other(2, 4) *= 1.01, other(4, 2) *= 1.01;
  check_refused([&] { fe::modal_data(mesh, "P", {"C"}, {.rigid = other}); }, Code::bad_value,
                {"ModeOptions::rigid", "ry, z"});
  CHECK(FlexibleBody{data}.data().omega.size() == 6);

  // Not for grids that merely have no rotations: the body turns there.
  fe::Mesh solid = boom(2);
  solid.dofs.erase(solid.dofs.end() - 3, solid.dofs.end());
  solid.K.conservativeResize(15, 15), solid.M.conservativeResize(15, 15);
  check_refused([&] { fe::interface_rows(solid, "C"); }, Code::bad_modes,
                {"C", "rx, ry, rz", "rigid body element"});
  check_refused([&] { fe::modal_data(solid, "P", {"C"}, {.rigid = rod()}); }, Code::bad_value,
                {"beam", "ModeOptions::rigid"});
}

TEST_CASE("matrices without positions become a body: positions and frames by statics") {
  fe::GridMatrices m = rows(kAll);
  const ModalData right = fe::modal_data(fe::to_mesh(m, kGrids), "P", {"C"});
  // Grid 2 in a frame of its own: v = T v_data.
  const Matrix3d T = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).matrix();
  for (MatrixXd* S : {&m.K, &m.M})
    for (const Index first : {6, 9}) {
      S->middleRows(first, 3) = (T.transpose() * S->middleRows(first, 3)).eval();
      S->middleCols(first, 3) = (S->middleCols(first, 3) * T).eval();
    }
  const std::vector<fe::Grid> grids = fe::grids_by_statics(m, 1);
  REQUIRE(grids.size() == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(grids[static_cast<std::size_t>(i)].id == i + 1);
    CHECK((grids[static_cast<std::size_t>(i)].position - Vector3d(i, 0, 0)).norm() <= 1e-10);
  }
  CHECK((grids[1].frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-10);
  CHECK(grids[2].frame.is_identity());
  const ModalData data = fe::modal_data(fe::to_mesh(m, grids), "1", {"3"});
  for (Index k = 0; k < 12; ++k) CHECK(relative(data.omega(k), right.omega(k)) <= 1e-9);
  CHECK((data.D_P - right.D_P).cwiseAbs().maxCoeff() <= 1e-9 * right.D_P.maxCoeff());

  // Planar, by a file of ten digits: the third coordinate has no effect.
  const auto planar = fe::grids_by_statics(through_a_file(rows(kPlanar)), 1);
  for (int i = 0; i < 3; ++i)
    CHECK((planar[static_cast<std::size_t>(i)].position - Vector3d(i, 0, 0)).norm() <= 1e-6);
  check_refused([&] { fe::grids_by_statics(m, 4); }, Code::unknown_name, {"beam", "grid 4"});
}

TEST_CASE("by statics: the misfit of rounded matrices is explained, supports are refused") {
  // Errors of half a unit of the seventh digit: K resists rigid motion, and misfits are explained.
  fe::GridMatrices rounded = rows(kAll);
  for (Index j = 0; j < 18; ++j)
    for (Index i = 0; i <= j; ++i) {
      rounded.K(i, j) *= 1 + 5e-8 * std::cos(static_cast<double>(i * i + 3 * j));
      rounded.K(j, i) = rounded.K(i, j);
    }
  rounded.digits = 7;
  double worst = 0;
  for (const fe::Grid& g : fe::grids_by_statics(rounded, 1)) worst = std::max(worst, g.noise);
  CHECK(worst > 1e-9);
  CHECK(worst < 1e-3);
  // The same errors in matrices that claim 15 digits: resistance above 1e-6 is a support, below it
  // counts as their error.
  rounded.digits = 15;
  CHECK_NOTHROW(fe::grids_by_statics(rounded, 1));
  fe::GridMatrices held = rows(kAll);
  held.K(7, 7) *= 1 + 1e-4;  // grid 2 held along y
  check_refused([&] { fe::grids_by_statics(held, 1); }, Code::bad_modes,
                {"beam", "grid 1", "supports"});
}

TEST_CASE("by statics: a null space of K that is no rigid motion is refused, in any unit") {
  // Rows of grid 3 in the order y, x, z: K is free, but its grid 3 is in a left-handed frame.
  for (const double metre : {1.0, 1e3}) {
    CAPTURE(metre);
    fe::GridMatrices m = rows(kAll);
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(18);
    for (const Index first : {0, 6, 12}) scale.segment<3>(first).setConstant(1 / metre);
    m.K = (scale.asDiagonal() * m.K * scale.asDiagonal()).eval();
    for (const fe::Grid& g : fe::grids_by_statics(m, 1)) CHECK(g.noise <= 1e-10);
    Eigen::PermutationMatrix<18> swap;
    swap.setIdentity();
    swap.applyTranspositionOnTheRight(12, 13);
    m.K = (swap.transpose() * m.K * swap).eval();
    check_refused([&] { fe::grids_by_statics(m, 1); }, Code::bad_modes,
                  {"grid 3", "beam", "grid 1", "rigid body", "rows of other grids"});
  }
}
