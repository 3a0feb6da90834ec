// A file of a finite-element program to a body in one call: each kind of file, what is told of it,
// and what is refused with the way out.
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

TEST_CASE("DMIG without positions, CalculiX and CSV") {
  const std::string wing = kData + "/nastran_dmig_flying_wing/sol103_maewing1_femv5p1.pch";
  const fe::Import punch = fe::import_body(
      wing, {.parent = "1010", .units = {.length = 0.0254, .mass = 175.12683524647636}});
  REQUIRE(punch.body);
  CHECK(punch.ports.size() == 71);
  CHECK(has_line(punch.text, {"statics", "1010"}));

  const std::string beam = kData + "/calculix_beam/beam_free_mat.sti";
  const fe::Import calculix = fe::import_body(beam, {.parent = "900001", .children = {"900003"}});
  REQUIRE(calculix.body);
  CHECK(calculix.ports == std::vector<std::string>{"900001", "900003"});
  CHECK(fe_test::relative(calculix.body->D_P(0, 0), 6.48) <= 1e-12);

  const std::string csv = kData + "/nastran_cantilever/cantilever.csv";
  CHECK(fe::import_body(csv).body->omega.size() == 3);
  check_refused([&] { fe::import_body(csv, {.parent = "P"}); }, Code::bad_value,
                {"cantilever.csv"});
}

TEST_CASE("OP2 of a normal modes analysis") {
  const fe::Import found =
      fe::import_body(kOp2, {.parent = "1", .children = {"3"}, .units = {.length = 1e-3}});
  REQUIRE(found.body);
  CHECK(found.ports.size() == 7);
  CHECK(has_line(found.text, {"MPFACS", "6 x 3"}));
  CHECK(found.body->children[0].name == "3");
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

TEST_CASE("other files are refused with what to ask of the program") {
  check_refused([&] { fe::import_body(kData + "/nastran_cantilever/pn_mwe_s-solution_1.dat"); },
                Code::bad_file, {"pn_mwe_s-solution_1.dat", "EXTSEOUT"});
  const titop_test::Folder folder;
  folder.write("m.f06", "1   MSC.NASTRAN JOB\n");
  check_refused([&] { fe::import_body(folder.path / "m.f06"); }, Code::bad_file, {"EXTSEOUT"});
  folder.write("m.bin", std::string("\1\2\0\0rubbish", 11));
  check_refused([&] { fe::import_body(folder.path / "m.bin"); }, Code::bad_file, {"m.bin"});
  std::filesystem::copy_file(kOp4, folder.path / "alone.op4");
  check_refused([&] { fe::import_body(folder.path / "alone.op4"); }, Code::bad_file,
                {"alone.op4", "--grids", "ASMBULK"});
  check_refused([&] { fe::import_body(kOp4, {.stiffness = "KZZ", .mass = "MXX"}); },
                Code::unknown_name, {"KZZ", "KXX"});
  check_refused([&] { fe::import_body(kOp4, {.parent = "4"}); }, Code::unknown_name, {"4"});
}
