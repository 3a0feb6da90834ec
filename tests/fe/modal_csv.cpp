// Modal data as text: the Nastran cantilever, units, normalisation, round trip, and refusals.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>
#include <titop/titop.hpp>

#include "dynamics.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::Index;
using fe_test::relative;
using titop_test::check_refused;
using titop_test::replaced;
using titop_test::says;

namespace {

const std::string kFolder = TITOP_DATA_DIR "/nastran_cantilever/";

ModalData read(const std::string& text) {
  const titop_test::Folder folder;
  folder.write("m.csv", text);
  return fe::read_modal_csv(folder.path / "m.csv");
}

const std::string kSmall =
    "# two modes\n"
    "units, 0.5, 4, 2\n"
    "D_P, 2, 0, 0, 0, 0, 0\nD_P, 0, 2, 0, 0, 0, 6\nD_P, 0, 0, 2, 0, -6, 0\n"
    "D_P, 0, 0, 0, 1, 0, 0\nD_P, 0, 0, -6, 0, 20, 0\nD_P, 0, 6, 0, 0, 0, 20\n"
    "child, C 1, 8, 0, 0\n\n"
    "mode, 3, 0.01, 1, 0, 0, 0, 0, 0,  0.5, 0, 0, 0, 0, 0\n"
    "mode, 6, 0.01, 0, 2, 0, 0, 0, 8,  0, 3, 0, 0, 0, 4   # at MAX\n"
    "modal mass, 16\n";

void refused(const std::string& text, std::initializer_list<std::string_view> names) {
  titop_test::check_refused([&] { read(text); }, Code::bad_file, names);
}

Error unwritable(const ModalData& data) {
  return titop_test::error_of([&] { fe::modal_csv(data); });
}

}  // namespace

TEST_CASE("cantilever: participation factors are those of its shapes and masses") {
  const ModalData data = fe::read_modal_csv(kFolder + "cantilever.csv");
  REQUIRE(data.omega.size() == 3);
  CHECK(data.omega(0) == 562.726746);
  CHECK((data.children[0].PC - Vector3d(0.1, 0, 0)).norm() <= 1e-16);
  // Lumped by hand [kg, mm]: five elements of a 10 mm rod, 5 kg at the tip (grid 3).
  const double element = 2.711e-6 * std::numbers::pi * 100 * 20, inertia = element * 100 / 4;
  const auto at = [](int grid) { return grid == 3 ? 100.0 : 20.0 * (grid - 3); };
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(3, 6);
  std::ifstream file(kFolder + "OUGV1.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream fields(line);
    int mode = 0, grid = 0;
    double x = 0, y = 0, z = 0, rx = 0, ry = 0, rz = 0;
    fields >> mode >> grid >> x >> y >> z >> rx >> ry >> rz;
    if (grid < 3) continue;
    const double m = grid == 3 ? 5 + element / 2 : element;
    const double J = grid == 3 ? inertia / 2 : inertia;
    Eigen::RowVectorXd row(6);
    row << m * x, m * y, m * z, 0, -m * z * at(grid) + J * ry, m * y * at(grid) + J * rz;
    L.row(mode - 1) += row;
  }
  L.rightCols(3) *= 1e-3;  // [m]
  // Shapes are of single precision, 2^-24 of themselves off; columns in [sqrt(kg)] and in
  // [sqrt(kg) m] each by themselves.
  for (const Index first : {0, 3}) {
    const Eigen::MatrixXd expected = L.middleCols(first, 3);
    CHECK((data.L_P.middleCols(first, 3) - expected).cwiseAbs().maxCoeff() <=
          std::exp2(-24) * expected.cwiseAbs().maxCoeff());
  }
  CHECK(relative(data.D_P(0, 0), 5 + 5 * element) <= 1e-7);  // with the mass on the clamped grid
  CHECK(relative(data.D_P(4, 4), 50291.489454230854e-6) <= 1e-14);
}

TEST_CASE("cantilever: the body it makes") {
  const FlexibleBody body = fe::read_modal_csv(kFolder + "cantilever.csv");
  const ModalReport report = modal_report(body.data());
  CHECK(report.residual.verdict == Definiteness::singular);
  CHECK(report.residual.component == 3);  // roll is not flexible and has no inertia
  CHECK(report.children[0].rank == 3);
  Diagram d{"cantilever"};
  ground(d.add("beam", body));
  const std::vector<Pole> poles = compile(d).poles();
  REQUIRE(poles.size() == 3);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(relative(poles[k].omega, body.data().omega(static_cast<Index>(k))) <= 1e-14);
  // Freed, its roll would need what the report calls singular.
  Diagram freed{"freed"};
  auto beam_alone = freed.add("beam", body);
  release(beam_alone);
  beam_alone.child.force = freed.input("u", 6);
  freed.output("a", 6) = beam_alone.child.accel;
  check_refused([&] { compile(freed); }, Code::improper, {"beam.parent", "residual mass", "rx"});
  // Tip flexibility of the beam with shear (a rod's factor is 0.9), except for the higher modes.
  const double E = 6.898e10, G = E / 2.66, A = std::numbers::pi * 1e-4, I = A * 1e-4 / 4;
  const Eigen::MatrixXd Phi = body.data().children[0].Phi_C;
  const double flexibility =
      Phi.row(1).cwiseAbs2().dot(body.data().omega.cwiseAbs2().cwiseInverse().transpose());
  const double beam = 1e-3 / (3 * E * I) + 0.1 / (0.9 * G * A);
  CHECK(flexibility <= beam);
  CHECK(flexibility >= 0.999 * beam);
}

TEST_CASE("units, modal masses, names with blanks") {
  const ModalData d = read(kSmall);
  CHECK(d.omega == Eigen::Vector2d(1.5, 3));
  CHECK(d.xi == Eigen::Vector2d(0.01, 0.01));
  CHECK(d.D_P(0, 0) == 8);
  CHECK(d.D_P(1, 5) == 12);
  CHECK(d.D_P(4, 4) == 20);
  CHECK(d.L_P(0, 0) == 2);
  CHECK(d.L_P(1, 1) == 1);  // 2 / sqrt(16) * sqrt(4)
  CHECK(d.L_P(1, 5) == 2);
  CHECK(d.children[0].name == "C 1");
  CHECK(d.children[0].PC == Vector3d(4, 0, 0));
  CHECK(d.children[0].Phi_C(0, 0) == 0.25);
  CHECK(d.children[0].Phi_C(1, 1) == 0.375);
  CHECK(d.children[0].Phi_C(5, 1) == 1);
}

TEST_CASE("written and read again: the same to the last bit") {
  Beam beam{
      .length = 1.3, .section = tube(0.05, 0.045), .material = {.E = 70e9, .nu = 0.3, .rho = 2700}};
  beam.elements = 3;
  beam.modes.xi = {0.003};
  const ModalData data = modal_data(beam);
  const ModalData again = read(fe::modal_csv(data));
  CHECK(again.omega == data.omega);
  CHECK(again.xi == data.xi);
  CHECK(again.L_P == data.L_P);
  CHECK(again.D_P == data.D_P);
  CHECK(again.digits == data.digits);
  CHECK(again.children[0].Phi_C == data.children[0].Phi_C);
  CHECK(again.children[0].PC == data.children[0].PC);
}

TEST_CASE("a scaled body is the same body: transfer in inch and lbf") {
  const ModalData SI = modal_data(Beam{.length = 1.3,
                                       .section = tube(0.05, 0.045),
                                       .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                       .elements = 2});
  const DataUnits inch{.length = 0.0254, .mass = 175.12683524647636};
  const DataUnits back{.length = 1 / inch.length, .mass = 1 / inch.mass};
  const auto response = [](const ModalData& data) {
    Diagram d{"beam"};
    auto b = d.add("b", FlexibleBody(data));
    b.parent.force = -d.input("F", 6);
    d.output("a", 6) = b.child.accel;
    return compile(d).transfer({2, 900});
  };
  const Eigen::MatrixXcd G = response(SI), inches = response(scaled(SI, back));
  Eigen::MatrixXcd expected = G;  // [m/s^2 / N], [1/(N s^2 m)]...
  const double force = inch.mass * inch.length, length = inch.length;
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      expected(i, j) *= (i < 3 ? 1 / length : 1) * (j < 3 ? force : force * length);
  CHECK((inches - expected).cwiseAbs().maxCoeff() <= 1e-12 * expected.cwiseAbs().maxCoeff());
  CHECK((response(scaled(scaled(SI, back), inch)) - G).cwiseAbs().maxCoeff() <=
        1e-12 * G.cwiseAbs().maxCoeff());
  CHECK_THROWS_AS(scaled(SI, {.length = -1}), Error);
}

TEST_CASE("the cantilever cut at any byte of its last line is refused") {
  std::ifstream file(kFolder + "cantilever.csv");
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  REQUIRE(whole.back() == '\n');
  CHECK(read(whole).omega.size() == 3);
  const auto line = whole.rfind('\n', whole.size() - 2) + 1;
  const std::string place = fmt::format("m.csv:{}", std::count(whole.begin(), whole.end(), '\n'));
  for (std::size_t length = line + 1; length < whole.size(); ++length)
    refused(whole.substr(0, length), {place, "'" + whole.substr(line, length - line) + "'"});
}

TEST_CASE("entries allowed once are refused the second time") {
  refused(replaced(kSmall, "D_P, 2", "units, 1, 1, 1\nD_P, 2"), {"m.csv:3", "units", "line 2"});
  refused(kSmall + "digits, 7\ndigits, 8\n", {"m.csv:15", "digits"});
  refused(kSmall + "at P, 1\nat P, 1\n", {"m.csv:15", "at P"});
  refused(kSmall + "modal mass, 16\n", {"m.csv:14", "modal mass", "mode 2"});
  refused(replaced(kSmall, "mode, 3", "child, C 1, 0, 0, 0\nmode, 3"),
          {"m.csv:11", "child", "C 1"});
}

TEST_CASE("data that could not be read again are not written") {
  const ModalData good = read(kSmall);
  for (const char* name : {"a,b", "a#b", " a", "a\t", "", "a\nb"}) {
    ModalData data = good;
    data.children[0].name = name;
    CHECK(says(unwritable(data), Code::bad_value, {std::string("'") + name + "'"}));
  }
  ModalData data = good;
  data.xi.resize(1);
  CHECK(says(unwritable(data), Code::size, {"xi", "1 x 1"}));
  data = good;
  data.L_P.resize(2, 5);
  CHECK(says(unwritable(data), Code::size, {"L_P", "2 x 5"}));
  data = good;
  data.children[0].Phi_C.resize(6, 3);
  CHECK(says(unwritable(data), Code::size, {"Phi_C", "C 1", "6 x 3"}));
}

TEST_CASE("broken modal data are refused with line and field") {
  refused(replaced(kSmall, "mode, 3", "mode, x"), {"m.csv:11", "'x'", "field 2"});
  refused(replaced(kSmall, "mode, 3,", "mode, 3, 1,"),
          {"m.csv:11", "15", "mode", "14", "omega", "L_P", "Phi", "1"});
  refused(replaced(kSmall, "mode, 3,", "mode,"), {"m.csv:11", "13", "mode", "14"});
  refused("digits, 0\n" + kSmall, {"m.csv:1", "0", "digits"});
  refused(replaced(kSmall, "modal mass, 16", "modal mass, 0"), {"m.csv:13", "modal mass", "0"});
  refused(replaced(kSmall, "D_P, 2, 0, 0, 0, 0, 0\n", ""), {"m.csv", "5", "D_P"});
  refused(replaced(kSmall, "units, 0.5", "units, -0.5"), {"m.csv:2", "-0.5"});
  refused(replaced(kSmall, "child", "grid"), {"m.csv:9", "'grid'", "units, digits"});
  refused(kSmall + "child, D, 0, 0, 0\n", {"m.csv:14", "child", "mode"});
  refused(replaced(kSmall, "0.5, 0, 0, 0, 0, 0", "inf, 0, 0, 0, 0, 0"),
          {"m.csv:11", "'inf'", "field 10"});
}
