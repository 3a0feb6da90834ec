// A Craig-Bampton pair of Nastran as a body of four ports: weighed, clamped at its grids, free, and
// two copies joined at four grids. Against its own K and M, assembled without the library.
#include <doctest/doctest.h>

#include <fstream>
#include <sstream>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "dynamics.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;

namespace {

const std::string kFolder = TITOP_DATA_DIR "/nastran_op4_superelement/";
const std::vector<int> kOrder = {3, 11, 19, 27};

/// z10 along x, x10 along y of the basic frame (outboard.asm).
Rotation frame_10() {
  return Rotation::matrix((Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished());
}

fe::GridMatrices matrices() {
  const auto file = fe::read_op4(kFolder + "outboard.op4");
  return fe::grid_matrices("outboard", fe::find_matrix(file, "KXX").value,
                           fe::find_matrix(file, "MXX").value, kOrder, 15);
}

std::vector<fe::Grid> grids() {  // [mm]
  return {{3, {600, 0, 300}, {}, "G3"},
          {11, {600, 300, 300}, frame_10(), "G11"},
          {19, {600, 300, 0}, {}, "G19"},
          {27, {600, 0, 0}, {}, "G27"}};
}

FlexibleBody body(const std::string& parent, const std::vector<std::string>& children) {
  const fe::Mesh mesh = fe::to_mesh(matrices(), grids());
  return scaled(fe::modal_data(mesh, parent, children), {.length = 1e-3});
}

/// Omegas of K x = omega^2 M x other than those of so many rigid motions, ascending: by Cholesky of
/// M, so that the slowest is off by rounding of the fastest omega^2 over its own.
VectorXd omegas(const MatrixXd& K, const MatrixXd& M, Index rigid) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K, M);
  return solver.eigenvalues().tail(K.rows() - rigid).cwiseSqrt();
}

void check_poles(const std::vector<Pole>& poles, const VectorXd& expected, double tolerance) {
  REQUIRE(poles.size() == static_cast<std::size_t>(expected.size()));
  double worst = 0;
  for (Index i = 0; i < expected.size(); ++i)
    worst = std::max(worst, relative(poles[static_cast<std::size_t>(i)].omega, expected(i)));
  CHECK(worst <= tolerance);
}

}  // namespace

TEST_CASE("superelement: mass about the origin, and no stiffness against rigid motion") {
  const fe::Mesh mesh = fe::to_mesh(matrices(), grids());
  const MatrixXd R = fe::rigid_motions(mesh, Vector3d::Zero());
  std::ifstream file(kFolder + "weight_check.csv");
  REQUIRE(file.good());
  MatrixXd expected = MatrixXd::Zero(6, 6);
  for (Index i = 0; i < 6; ++i) {
    std::string line, field;
    std::getline(file, line);
    std::istringstream fields(line);
    for (Index j = 0; j < 6 && std::getline(fields, field, ','); ++j)
      expected(i, j) = std::stod(field);
  }
  const double off = (R.transpose() * mesh.M * R - expected).cwiseAbs().maxCoeff();
  CHECK(off <= 1e-7 * expected.cwiseAbs().maxCoeff());  // 7 digits are printed
  const fe::MeshReport report = fe::mesh_report(mesh);
  CHECK((mesh.K * R).cwiseAbs().maxCoeff() <= 5e-13 * mesh.K.cwiseAbs().maxCoeff());
  CHECK(report.KR_terms <= 1e-9);
  // Without grid 11's own frame its rows would not rotate with it.
  auto unturned = grids();
  unturned[1].frame = {};
  CHECK(fe::mesh_report(fe::to_mesh(matrices(), unturned)).KR_terms > 1e-3);
}

TEST_CASE("data of a held structure, in two units, or without a grid's own frame are refused") {
  const auto refused = [](const fe::Mesh& mesh) {
    return titop_test::error_of([&] { fe::modal_data(mesh, "G3", {"G11"}); });
  };
  const fe::Mesh good = fe::to_mesh(matrices(), grids());
  CHECK(refused(good).mistakes().empty());
  fe::Mesh sprung = good;  // a spring to ground
  sprung.K(7, 7) *= 1 + 1e-4;
  CHECK(titop_test::says(refused(sprung), Code::bad_modes, {"outboard", "G11", "*BOUNDARY"}));
  fe::Mesh metres = good;
  for (fe::MeshPoint& p : metres.points) p.position /= 1000;
  CHECK(titop_test::says(refused(metres), Code::bad_modes, {"outboard", "*BOUNDARY"}));
  auto unturned = grids();
  unturned[1].frame = {};
  CHECK(titop_test::says(refused(fe::to_mesh(matrices(), unturned)), Code::bad_modes,
                         {"outboard", "*BOUNDARY"}));
  // Clamped: the remaining rows when one grid is held.
  std::vector<Index> rest;
  fe::Mesh clamped = good;
  clamped.dofs.clear();
  for (Index i = 0; i < good.M.rows(); ++i)
    if (good.dofs[static_cast<std::size_t>(i)].point != good.dofs[18].point) {
      rest.push_back(i);
      clamped.dofs.push_back(good.dofs[static_cast<std::size_t>(i)]);
    }
  clamped.M = good.M(rest, rest), clamped.K = good.K(rest, rest);
  CHECK(titop_test::says(refused(clamped), Code::bad_modes, {"outboard", "*BOUNDARY"}));
}

TEST_CASE("superelement held at its four grids has its fixed-interface modes") {
  Diagram d{"held"};
  auto a = d.add("a", body("G3", {"G11", "G19", "G27"}));
  ground(a);
  for (const char* grid : {"G11", "G19", "G27"}) ground(a.child(grid));
  VectorXd expected = matrices().K.bottomRightCorner(22, 22).diagonal().cwiseSqrt();
  std::sort(expected.begin(), expected.end());
  check_poles(compile(d).poles(), expected, 1e-9);
}

TEST_CASE("superelement let go has the elastic modes of its own K and M") {
  Diagram d{"free"};
  release(d.add("a", body("G3", {"G11", "G19", "G27"})));
  const fe::GridMatrices m = matrices();
  check_poles(compile(d).poles(), omegas(m.K, m.M, 6), 1e-9);
}

TEST_CASE("two superelements joined at four grids: 62 elastic modes, of which grids show 40") {
  Diagram d{"pair"};
  auto a = d.add("a", body("G3", {"G11", "G19", "G27"}));
  auto b = d.add("b", body("G11", {"G3", "G19", "G27"}));
  a.parent.force = -d.input("F3", 6);
  mount(b, a.child("G11"));
  weld(b.child("G19"), a.child("G19"));
  weld(b.child("G27"), a.child("G27"));
  // Both have a point at grid 3; a's is its parent, whose force it exerts.
  b.child("G3").accel = Rotation().named("b", "a") * a.parent.accel;
  a.parent.force += Rotation().named("a", "b") * b.child("G3").reaction;
  d.output("a3", 6) = a.parent.accel;
  for (const char* grid : {"G11", "G19", "G27"}) {
    a.child(grid).force += d.input(std::string("F") + grid, 6);
    d.output(std::string("a") + grid, 6) = a.child(grid).accel;
  }
  const System system = compile(d);
  CHECK(system.order() == 124);

  // By hand: grids once, modal coordinates twice.
  const fe::GridMatrices m = matrices();
  MatrixXd K = MatrixXd::Zero(68, 68), M = K;
  for (const Index first : {24, 46}) {
    std::vector<Index> rows;
    for (Index i = 0; i < 46; ++i) rows.push_back(i < 24 ? i : first + i - 24);
    K(rows, rows) += m.K;
    M(rows, rows) += m.M;
  }
  check_poles(system.poles(), omegas(K, M, 6), 1e-9);

  const Minimized least = minimize(system.state_space());
  CHECK(least.model.order() == 80);
  int removed = 0;
  for (const JudgedMode& mode : least.order.removed) removed += mode.states;
  CHECK(removed == 44);
  const std::complex<double> s{3, 40};
  const Eigen::MatrixXcd full = system.transfer(s);
  CHECK((least.model.transfer(s) - full).cwiseAbs().maxCoeff() <=
        1e-9 * full.cwiseAbs().maxCoeff());
}

TEST_CASE("superelement: grids that do not fit are named") {
  auto wrong = grids();
  wrong.pop_back();
  wrong.push_back({28, {0, 0, 0}, {}, "G28"});
  const Error error = titop_test::error_of([&] { fe::to_mesh(matrices(), wrong); });
  CHECK(error.mistakes().size() == 2);
  CHECK(titop_test::says(error, Code::unknown_name, {"outboard", "grid 28"}));
  CHECK(titop_test::says(error, Code::unknown_name, {"outboard", "grid 27", "Grid{.id = 27"}));
  CHECK_THROWS_AS(fe::grid_matrices("x", MatrixXd::Zero(5, 5), MatrixXd::Zero(5, 5), {1}, 15),
                  Error);
}
