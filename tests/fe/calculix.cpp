#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/graph/error.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/names.hpp"

/// The real beam: values expected from its files. Source: examples/data/calculix_beam/README.md.

using namespace titop;
using fe_test::relative;

namespace {

const std::string kFolder = TITOP_DATA_DIR "/calculix_beam/";

fe::Mesh beam() {
  return fe::read_calculix(fe::calculix_files(kFolder + "beam_free_mat"),
                           {{"P", 900001}, {"C", 900003}});
}

std::vector<double> expected_omegas() {
  std::ifstream file(kFolder + "expected_clamped_free.csv");
  std::vector<double> omegas;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) omegas.push_back(std::stod(line.substr(line.rfind(',') + 1)));
  return omegas;
}

}  // namespace

TEST_CASE("CalculiX beam: rows, points, rotation nodes") {
  const fe::Mesh mesh = beam();
  CHECK(mesh.dofs.size() == 348);
  CHECK(mesh.M.rows() == 348);
  CHECK(mesh.points.size() == 114);  // 128 solid nodes, 16 of them on rigid faces, and P, C
  CHECK(fe::dof_name(mesh, 0) == "9.x");
  const auto P = fe::interface_rows(mesh, "P"), C = fe::interface_rows(mesh, "C");
  CHECK(fe::dof_name(mesh, P[4]) == "P.ry");
  CHECK(fe::dof_name(mesh, C[0]) == "C.x");
  CHECK(mesh.points[fe::find_point(mesh, "C")].position == Vector3d(1, 0, 0));
  CHECK(mesh.points[fe::find_point(mesh, "9")].position == Vector3d(0.05, -0.03, -0.02));
  CHECK(fe::interface_rows(mesh, "900003") == C);
  CHECK((mesh.K - mesh.K.transpose()).cwiseAbs().maxCoeff() == 0);
  CHECK(mesh.K(0, 0) == 2.4887054236899e+09);
  CHECK(mesh.digits == 14);
}

TEST_CASE("CalculiX beam: clamped-free frequencies of the program's own run") {
  const ModalData data = fe::modal_data(beam(), "P", {"C"});
  REQUIRE(data.omega.size() == 342);
  const std::vector<double> expected = expected_omegas();
  REQUIRE(expected.size() == 20);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    INFO("mode ", k + 1);
    CHECK(relative(data.omega(static_cast<Eigen::Index>(k)), expected[k]) <= 1e-8);
  }
  CHECK(data.children[0].PC == Vector3d(1, 0, 0));
  CHECK(data.xi.isZero(0));
}

TEST_CASE("CalculiX beam: mass and stiffness against rigid motions") {
  const fe::MeshReport report = fe::mesh_report(beam());
  const double m = 2700 * 0.06 * 0.04 * 1.0;
  for (int i = 0; i < 3; ++i) CHECK(relative(report.mass.mass(i), m) <= 1e-12);
  CHECK((report.mass.centre - Vector3d(0.5, 0, 0)).norm() <= 1e-12);
  // Solid box about its centre.
  const Vector3d box = m / 12 * Vector3d(0.0036 + 0.0016, 1 + 0.0016, 1 + 0.0036);
  CHECK((report.mass.inertia - Matrix3d(box.asDiagonal())).cwiseAbs().maxCoeff() <= 1e-11);
  CHECK(report.mass.misfit <= 1e-12);
  CHECK(report.KR <= 2e-14);
  CHECK(report.KR_terms <= 1e-13);
  REQUIRE(report.geometry.has_value());
  CHECK(relative(report.geometry->mass.x(), m) <= 1e-12);
  CHECK((report.geometry->centre - Vector3d(0.5, 0, 0)).norm() <= 1e-12);
  CHECK(titop_test::has_line(fe::to_string(report, DataUnits{}), {"6.48 kg", "0.5"}));
}

TEST_CASE("CalculiX beam: a wrong position is seen in K R, a wrong mass in the mass") {
  fe::Mesh mesh = beam();
  mesh.points[fe::find_point(mesh, "40")].position.x() += 1e-6;
  CHECK(fe::mesh_report(mesh).KR_terms > 1e-9);
  mesh = beam();
  mesh.M *= 1.001;
  CHECK(relative(fe::mesh_report(mesh).mass.mass.x(), 6.48) > 5e-4);
}

TEST_CASE("CalculiX beam: the effect of its 14 digits is predicted") {
  const fe::Mesh mesh = beam();
  const std::vector<double> expected = expected_omegas();
  const Eigen::VectorXd omega = fe::modal_data(mesh, "P", {}).omega;
  const Eigen::VectorXd spread = fe::omega_uncertainty(mesh, "P", 6);
  double sum = 0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    INFO("mode ", k + 1);
    const double error = relative(omega(k), expected[static_cast<std::size_t>(k)]);
    CHECK(error <= 4 * spread(k));
    sum += error / spread(k);
  }
  CHECK(sum / 6 > 0.3);  // an estimate, not only a bound
}

TEST_CASE("CalculiX beam: residual mass, ranks and effective masses of all modes") {
  const ModalData data = fe::modal_data(beam(), "P", {"C"});
  const ModalReport report = modal_report(data);
  CHECK(report.residual.verdict == Definiteness::definite);
  // Small but definite: the residual mass is that of 12 mm of the beam, rotating about their own
  // centre.
  const Matrix6& D_P0 = report.residual.D_P0;
  CHECK(relative(D_P0(4, 4) / D_P0(2, 2), 0.04 * 0.04 / 12) <= 1e-3);
  CHECK(report.residual.component == 4);
  CHECK(report.residual.smallest > 1e-6);
  CHECK(report.residual.smallest < 1e-5);
  REQUIRE(report.children.size() == 1);
  CHECK(report.children[0].rank == 6);
  CHECK(report.children[0].blocked.empty());
  // The mass on the clamped face does not move with any mode.
  for (int j = 0; j < 6; ++j) {
    CHECK(report.effective.total(j) < 1);
    CHECK(report.effective.total(j) > 0.95);
  }
  // First bendings carry the textbook's 61.3 % of the mass.
  CHECK(std::abs(report.effective.fraction(0, 2) - 0.613) < 0.01);
  CHECK(std::abs(report.effective.fraction(1, 1) - 0.613) < 0.01);
}

TEST_CASE("CalculiX beam: line ends of Windows change nothing") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("titop_calculix_crlf_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  for (const char* end : {".sti", ".mas", ".dof", ".inp"}) {
    std::ifstream in(kFolder + "beam_free_mat" + end);
    std::ofstream out(folder / (std::string("beam") + end), std::ios::binary);
    std::string line;
    while (std::getline(in, line)) out << line << "\r\n";
  }
  const fe::Mesh windows = fe::read_calculix(fe::calculix_files(folder / "beam"));
  std::filesystem::remove_all(folder);
  CHECK(windows.K == beam().K);
  CHECK(windows.M == beam().M);
  CHECK(windows.points.size() == 114);
}
