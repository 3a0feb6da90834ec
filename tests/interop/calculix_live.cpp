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
