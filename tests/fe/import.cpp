// A file of a finite-element program to a body in one call: each kind of file, the report of it,
// and refusals with the way out.
#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "dynamics.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using titop_test::check_refused;
using titop_test::has_line;

namespace {

const std::string kData = TITOP_DATA_DIR;
const std::string kOp4 = kData + "/nastran_op4_superelement/outboard.op4";
const std::string kOp2 = kData + "/nastran_cantilever/pn_mwe_s-solution_1.op2";

}  // namespace

TEST_CASE("OP4 with its .asm: contents, checks, ports, and the body of tests/fe/superelement.cpp") {
  const fe::Import found = fe::import_body(kOp4, {.units = {.length = 1e-3}});
  CHECK(found.ports == std::vector<std::string>{"3", "11", "19", "27"});
  CHECK(!found.body);
  CHECK(has_line(found.text, {"KXX", "46 x 46", "15 digits"}));
  // Of matrices that are named no others are read.
  const fe::ImportOptions named{.stiffness = "KXX", .mass = "MXX"};
  CHECK(has_line(fe::import_body(kOp4, named).text, {"was not asked for"}));
  CHECK(!has_line(found.text, {"was not asked for"}));
  const fe::Import made =
      fe::import_body(kOp4, {.parent = "3", .children = {"11", "27"}, .units = {.length = 1e-3}});
  REQUIRE(made.body);
  CHECK(made.body->omega.size() == 40);
  CHECK((made.body->children[0].PC - Vector3d(0, 0.3, 0)).norm() <= 1e-12);
  CHECK(fe_test::relative(made.body->D_P(0, 0), 1.590384) <= 1e-6);  // weight_check.csv
  CHECK(has_line(made.text, {"undamped"}));
  const System system = compile(diagram_of_body(*made.body));
  CHECK(system.inputs().size() == 18);
  CHECK(system.outputs().size() == 18);
}

TEST_CASE("Rayleigh damping is by seconds, whatever the file's unit of time") {
  const fe::Rayleigh damping{0.8, 1e-4};
  for (const double time : {1.0, 1e-3, 60.0}) {
    const fe::Import found = fe::import_body(kOp4, {.parent = "3",
                                                    .units = {.length = 1e-3, .time = time},
                                                    .modes = {.kept = 8, .rayleigh = damping}});
    REQUIRE(found.body);
    for (Eigen::Index i = 0; i < 8; ++i) {
      const double omega = found.body->omega(i);
      CHECK(fe_test::relative(found.body->xi(i),
                              (damping.mass / omega + damping.stiffness * omega) / 2) <= 1e-12);
    }
  }
}

TEST_CASE("DMIG without positions, CalculiX and CSV") {
  const std::string wing = kData + "/nastran_dmig_flying_wing/sol103_maewing1_femv5p1.pch";
  const fe::Import punch = fe::import_body(
      wing, {.parent = "1010", .units = {.length = 0.0254, .mass = 175.12683524647636}});
  REQUIRE(punch.body);
  CHECK(punch.ports.size() == 71);
  CHECK(punch.text.find("--units") == std::string::npos);
  CHECK(has_line(punch.text, {"statics", "1010", "not rigid by"}));

  const std::string beam = kData + "/calculix_beam/beam_free_mat.sti";
  const fe::Import calculix = fe::import_body(beam, {.parent = "900001", .children = {"900003"}});
  REQUIRE(calculix.body);
  CHECK(calculix.ports == std::vector<std::string>{"900001", "900003"});
  CHECK(fe_test::relative(calculix.body->D_P(0, 0), 6.48) <= 1e-12);

  const std::string csv = kData + "/nastran_cantilever/cantilever.csv";
  CHECK(fe::import_body(csv).body->omega.size() == 3);
}

TEST_CASE("options without effect on a kind of file are refused by name") {
  const auto refused = [](const std::string& file, const fe::ImportOptions& options,
                          std::initializer_list<std::string_view> names) {
    check_refused([&] { fe::import_body(file, options); }, Code::bad_value, names);
  };
  const std::string csv = kData + "/nastran_cantilever/cantilever.csv";
  const std::string beam = kData + "/calculix_beam/beam_free_mat.sti";
  refused(csv, {.parent = "P", .children = {"C"}}, {"cantilever.csv", "--parent", "--children"});
  refused(csv, {.units = {.length = 1e-3}}, {"cantilever.csv", "--units"});
  refused(csv,
          {.modes = {.residual = {"C"}, .xi = {0.01}, .rayleigh = fe::Rayleigh{1, 1}},
           .grids = "m.asm",
           .stiffness = "K"},
          {"--grids", "--matrices", "--modes", "rayleigh", "--xi"});
  refused(csv, {.modes = {.rigid = Matrix6::Identity()}}, {"--mass"});
  refused(kOp2, {.parent = "1", .modes = {.kept = 2}}, {"pn_mwe_s-solution_1.op2", "--modes"});
  refused(kOp2, {.parent = "1", .modes = {.rigid = Matrix6::Identity()}, .grids = "m.asm"},
          {"--mass", "--grids"});
  refused(beam, {.grids = "m.asm", .stiffness = "K", .mass = "M"},
          {"beam_free_mat.sti", "--grids", "--matrices"});
}

TEST_CASE("CalculiX: Young's modulus in the units of the file") {
  const titop_test::Folder folder;
  const std::string from = kData + "/calculix_beam/beam_free_mat";
  for (const char* ending : {".sti", ".mas", ".dof", ".inp"})
    std::filesystem::copy_file(from + ending, folder.path / ("beam" + std::string(ending)));
  const std::string warning = "Young's modulus";
  const auto file = folder.path / "beam.sti";
  CHECK(fe::import_body(file).text.find(warning) == std::string::npos);
  // 70e9 of a unit of pressure of 1e-3 Pa: 70 MPa.
  CHECK(fe::import_body(file, {.units = {.mass = 1e-3}}).text.find(warning) != std::string::npos);
}

TEST_CASE("OP2 of a normal modes analysis") {
  const fe::Import found =
      fe::import_body(kOp2, {.parent = "1", .children = {"3"}, .units = {.length = 1e-3}});
  REQUIRE(found.body);
  CHECK(found.ports.size() == 7);
  CHECK(has_line(found.text, {"MPFACS", "6 x 3"}));
  CHECK(has_line(found.text, {"at rest", "1, 2"}));
  CHECK(has_line(found.text, {"D_P", "lumped", "grid 1"}));
  CHECK(found.body->children[0].name == "3");
  // Its tables as another program has read them, in SI.
  const ModalData right = fe::read_modal_csv(kData + "/nastran_cantilever/cantilever.csv");
  Matrix6 D_P = right.D_P;
  D_P.diagonal().head<3>().array() -= 0.00851685768388;  // at P: not in RBMASSS
  CHECK((found.body->omega - right.omega).cwiseAbs().maxCoeff() <= 6e-8 * 6565);
  CHECK((found.body->L_P - right.L_P).cwiseAbs().maxCoeff() <= 1e-15 * 2.3);
  CHECK((found.body->D_P - D_P).cwiseAbs().maxCoeff() <= 1e-12 * 6);
  CHECK((found.body->children[0].PC - Vector3d(0.1, 0, 0)).norm() <= 1e-15);
  CHECK(found.body->xi.isZero(0));

  const fe::ImportOptions each{.parent = "1", .modes = {.xi = {0.01, 0.02, 0.03}}};
  CHECK(fe::import_body(kOp2, each).body->xi == Vector3d(0.01, 0.02, 0.03));
  check_refused(
      [&] {
        fe::import_body(kOp2, {.parent = "1", .modes = {.xi = {0.01, 0.02}}});
      },
      Code::size, {"2", "3 modes"});
  CHECK_NOTHROW(fe::import_body(kOp2, {.parent = "1", .modes = {.xi = {0.01}}}));
}

TEST_CASE("rows without stiffness and mass are dropped and listed") {
  // A rod along x of two grids with x alone, and a scalar point that no mode took.
  const titop_test::Folder folder;
  std::string text = "DMIG    KAAX    0       6       2       0\n";
  const auto entry = [&](const char* name, int g, int h, const char* value) {
    text += std::string("DMIG    ") + name + "    " + std::to_string(g) +
            "       1               " + std::to_string(h) + "       1       " + value + "\n";
  };
  entry("KAAX", 1, 1, "2.0"), entry("KAAX", 1, 2, "-2.0"), entry("KAAX", 2, 2, "2.0");
  text += "DMIG    KAAX    9       0               9       0       0.0\n";
  text += "DMIG    MAAX    0       6       2       0\n";
  entry("MAAX", 1, 1, "3.0"), entry("MAAX", 2, 2, "3.0");
  folder.write("rod.pch", text);
  const fe::Import found = fe::import_body(folder.path / "rod.pch");
  CHECK(has_line(found.text, {"1 rows", "scalar 9"}));
  CHECK(has_line(found.text, {"y, z, rx, ry, rz", "ModeOptions::rigid"}));
  CHECK(has_line(found.text, {"mass along x", "6"}));
  CHECK(found.ports == std::vector<std::string>{"1", "2"});
}

TEST_CASE("a scalar point with the number of a grid is not that grid") {
  const titop_test::Folder folder;
  std::string text = "DMIG    KAAX    0       6       2       0\n";
  const auto entry = [&](const char* name, int g, int c, int h, int d, const char* value) {
    text += std::string("DMIG    ") + name + "    " + std::to_string(g) + "       " +
            std::to_string(c) + "               " + std::to_string(h) + "       " +
            std::to_string(d) + "       " + value + "\n";
  };
  entry("KAAX", 1, 1, 1, 1, "2.0"), entry("KAAX", 1, 1, 2, 1, "-2.0");
  entry("KAAX", 2, 1, 2, 1, "2.0"), entry("KAAX", 9, 0, 9, 0, "5.0");
  text += "DMIG    MAAX    0       6       2       0\n";
  entry("MAAX", 1, 1, 1, 1, "3.0"), entry("MAAX", 2, 1, 2, 1, "3.0");
  entry("MAAX", 9, 0, 9, 0, "1.0");
  folder.write("rod.pch", text);
  folder.write("rod.asm", "GRID,1,,0.\nGRID,2,,1.\nGRID,9,,2.\n");
  const fe::Import found = fe::import_body(folder.path / "rod.pch");
  CHECK(has_line(found.text, {"rod.asm", "2"}));
  CHECK(found.ports == std::vector<std::string>{"1", "2"});
}

TEST_CASE("without a parent, positions by statics are from a grid that gives them") {
  // The first ten grids of the flying wing are soft parts of it.
  const std::string wing = kData + "/nastran_dmig_flying_wing/sol103_maewing1_femv5p1.pch";
  const fe::Import found = fe::import_body(wing);
  CHECK(found.ports.size() == 71);
  CHECK(has_line(found.text, {"statics", "not rigid by"}));
  CHECK(has_line(found.text, {"m, kg, s", "--units"}));
}

TEST_CASE("a file of CalculiX without the others names the one that is missing") {
  const titop_test::Folder folder;
  const std::string from = kData + "/calculix_beam/beam_free_mat";
  for (const char* ending : {".sti", ".dof", ".inp"})
    std::filesystem::copy_file(from + ending, folder.path / ("beam" + std::string(ending)));
  check_refused([&] { fe::import_body(folder.path / "beam.sti"); }, Code::bad_file,
                {"beam.sti", "beam.mas", "MATRIXSTORAGE"});
}

TEST_CASE("other files are refused with the output to request from the program") {
  check_refused([&] { fe::import_body(kData + "/nastran_cantilever/pn_mwe_s-solution_1.dat"); },
                Code::bad_file, {"pn_mwe_s-solution_1.dat", "--grids", "EXTSEOUT"});
  const titop_test::Folder folder;
  folder.write("m.f06", "1   MSC.NASTRAN JOB\n");
  check_refused([&] { fe::import_body(folder.path / "m.f06"); }, Code::bad_file,
                {"m.f06", "REAL EIGENVALUES", "METHOD"});
  folder.write("m.bin", std::string("\1\2\0\0rubbish", 11));
  check_refused([&] { fe::import_body(folder.path / "m.bin"); }, Code::bad_file, {"m.bin"});
  folder.write("m.op4.gz", std::string("\x1f\x8b\x08\0\0rubbish", 12));
  check_refused([&] { fe::import_body(folder.path / "m.op4.gz"); }, Code::bad_file,
                {"m.op4.gz", "gzip", "gunzip"});
  folder.write("odd.pch", "DMIG    KODD    0       6       2       0\n");
  check_refused([&] { fe::import_body(folder.path / "odd.pch"); }, Code::unknown_name,
                {"odd.pch", "no pair", "--matrices", "KODD"});
  std::filesystem::copy_file(kOp4, folder.path / "alone.op4");
  check_refused([&] { fe::import_body(folder.path / "alone.op4"); }, Code::bad_file,
                {"alone.op4", "KXX (46 x 46)", "MXX", "--grids", "ASMBULK"});
  check_refused([&] { fe::import_body(kOp4, {.stiffness = "KZZ", .mass = "MXX"}); },
                Code::unknown_name, {"KZZ", "KXX"});
  check_refused([&] { fe::import_body(kOp4, {.parent = "4"}); }, Code::unknown_name,
                {"point 4", "3, 11, 19, 27"});
}
