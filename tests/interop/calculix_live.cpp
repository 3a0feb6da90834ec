// Runs CalculiX on the decks of examples/data/calculix_beam and reads its output: the reader must
// match the installed program, not only the files kept here.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <titop/titop.hpp>

#include "support/skip.hpp"

namespace fs = std::filesystem;
using namespace titop;

namespace {

bool installed() { return std::system("command -v ccx >/dev/null 2>&1") == 0; }

/// Runs the deck in a scratch folder and returns that folder.
fs::path run_deck(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("titop-interop-" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::copy(fs::path(TITOP_DATA_DIR) / "calculix_beam" / (name + ".inp"), folder);
  const std::string command = "cd '" + folder.string() + "' && ccx " + name + " >ccx.log 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
  return folder;
}

fe::Mesh read(const fs::path& stem) {
  return fe::read_calculix(fe::calculix_files(stem), {{"P", 900001}, {"C", 900003}});
}

/// omega [rad/s] of the table that CalculiX prints, 7 digits.
std::vector<double> printed_omegas(const fs::path& dat) {
  std::ifstream file(dat);
  std::vector<double> omegas;
  std::string line;
  while (std::getline(file, line) && line.find("P A R T I C I P") == std::string::npos) {
    std::istringstream fields(line);
    int mode = 0;
    double lambda = 0, omega = 0, hertz = 0, imaginary = 0;
    if (fields >> mode >> lambda >> omega >> hertz >> imaginary &&
        mode == static_cast<int>(omegas.size()) + 1)
      omegas.push_back(omega);
  }
  return omegas;
}

}  // namespace

TEST_CASE("matrices of a live CalculiX run are those of the stored files") {
  if (!installed()) return titop_test::skip("CalculiX (ccx) is not installed");
  const fe::Mesh live = read(run_deck("beam_free_mat") / "beam_free_mat");
  const fe::Mesh kept = read(fs::path(TITOP_DATA_DIR) / "calculix_beam" / "beam_free_mat");
  REQUIRE(live.M.rows() == kept.M.rows());
  // 14 digits are printed; another processor may sum in another order.
  CHECK((live.K - kept.K).cwiseAbs().maxCoeff() <= 1e-12 * kept.K.cwiseAbs().maxCoeff());
  CHECK((live.M - kept.M).cwiseAbs().maxCoeff() <= 1e-12 * kept.M.cwiseAbs().maxCoeff());
}

namespace {

/// The deck without the rigid body of the end face, whose eight nodes stay free.
fs::path run_open_end() {
  const fs::path folder = fs::temp_directory_path() / "titop-interop-open-end";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ifstream deck(fs::path(TITOP_DATA_DIR) / "calculix_beam" / "beam_free_mat.inp");
  std::ofstream open(folder / "open.inp");
  int references = 0;
  bool rest = false;
  for (std::string line; std::getline(deck, line);) {
    references += line == "*NODE,NSET=NREF";
    rest = rest || line == "*STEP";
    if (references < 2 || rest) open << line << '\n';
  }
  open.close();
  REQUIRE(std::system(("cd '" + folder.string() + "' && ccx open >ccx.log 2>&1").c_str()) == 0);
  return folder / "open";
}

/// Displacement of C by a unit force or torque there, P held.
double compliance(const ModalData& beam, Eigen::Index axis) {
  return (beam.children.front().Phi_C.row(axis).array().square() /
          beam.omega.transpose().array().square())
      .sum();
}

}  // namespace

TEST_CASE("an interface of the end face is the rigid body that CalculiX makes of it") {
  if (!installed()) return titop_test::skip("CalculiX (ccx) is not installed");
  const fe::Mesh open = fe::read_calculix(fe::calculix_files(run_open_end()), {{"P", 900001}});
  const fe::NodeSet face = fe::box(open, {1, -1, -1}, {1, 1, 1});
  REQUIRE(face.points.size() == 8);
  const ModalData of_file = fe::modal_data(
      read(fs::path(TITOP_DATA_DIR) / "calculix_beam" / "beam_free_mat"), "P", {"C"});
  const auto with = [&](const fe::Coupling& coupling) {
    return fe::modal_data(fe::with_interface(open, "C", coupling), "P", {"C"});
  };
  const ModalData rigid = with(fe::rigid(face)), average = with(fe::average(face));
  for (Eigen::Index k = 0; k < 20; ++k) {
    CAPTURE(k);
    CHECK(std::abs(rigid.omega(k) / of_file.omega(k) - 1) <= 1e-8);
    CHECK(average.omega(k) <= of_file.omega(k) * (1 + 1e-8));
  }
  // A face that may warp yields more along the beam, and no less in any other direction.
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    CAPTURE(axis);
    const double exact = compliance(of_file, axis);
    CHECK(std::abs(compliance(rigid, axis) / exact - 1) <= 1e-7);
    CHECK(compliance(average, axis) >= exact * (1 - 1e-7));
  }
}

TEST_CASE("clamped-free frequencies of a scene are those that CalculiX computes itself") {
  if (!installed()) return titop_test::skip("CalculiX (ccx) is not installed");
  const std::vector<double> printed = printed_omegas(run_deck("beam_cf") / "beam_cf.dat");
  REQUIRE(printed.size() >= 10);
  const fe::Mesh mesh = read(run_deck("beam_free_mat") / "beam_free_mat");
  Diagram d{"clamped beam"};
  auto beam = d.add("beam", FlexibleBody(fe::modal_data(mesh, "P", {"C"}, {.kept = 20})));
  ground(beam);
  const std::vector<Pole> poles = compile(d).poles();
  REQUIRE(poles.size() == 20);
  for (std::size_t i = 0; i < 10; ++i) {
    CAPTURE(i);
    CHECK(std::abs(poles[i].omega - printed[i]) <= 1e-6 * printed[i]);  // 7 digits are printed
  }
}
