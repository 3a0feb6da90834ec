// Positions and frames from bulk data: fields of 8 and 16 columns and free ones, systems in
// systems, the real .asm, and refusals.
#include <doctest/doctest.h>

#include <titop/blocks/fe/bulk_data.hpp>
#include <titop/graph/error.hpp>

#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using titop_test::replaced;

namespace {

std::vector<fe::Grid> read(const std::string& text) {
  const titop_test::Folder folder;
  folder.write("m.bdf", text);
  return fe::read_grids(folder.path / "m.bdf");
}

/// System 3 lies at (0, 0, 2), its z along the basic x, its x along the basic y; system 4 at x = 1
/// of it, with the same axes.
const std::string kText =
    "SOL 103\n"
    "GRID = of the executive control\n"
    "BEGIN BULK\n"
    "$ systems\n"
    "CORD2R  3       0       0.      0.      2.      1.      0.      2.      +A\n"
    "+A      0.      1.      2.\n"
    "CORD2R* 4               3               1.0D+0          0.\n"
    "*       0.              1.              0.              1.\n"
    "*       2.              0.              0.\n"
    "grid,12,3,5.,,-1.+0,4\n"
    "GRID    9       4       1.      2.      3.\n"
    "GRID*   100                             1.234567890123  -2.5-1\n"
    "*       3.\n"
    "ENDDATA\n"
    "GRID    500             nonsense\n";

void refused(const std::string& text, std::initializer_list<std::string_view> names) {
  titop_test::check_refused([&] { read(text); }, Code::bad_file, names);
}

}  // namespace

TEST_CASE("grids in fields of 8 and 16 columns and free ones, systems in systems") {
  const std::vector<fe::Grid> grids = read(kText);
  REQUIRE(grids.size() == 3);
  CHECK(grids[0].id == 9);
  // (1, 2, 3) of system 4 is (2, 2, 3) of system 3: y' = 2, z' = 3, x' = 2 along y, z, x.
  CHECK((grids[0].position - Vector3d(3, 2, 4)).norm() <= 1e-15);
  CHECK(grids[0].frame.is_identity());
  CHECK(grids[1].id == 12);
  CHECK((grids[1].position - Vector3d(-1, 5, 2)).norm() <= 1e-15);
  Matrix3d T;
  T << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  CHECK((grids[1].frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
  CHECK(grids[2].position == Vector3d(1.234567890123, -0.25, 3));
}

TEST_CASE("the boundary grids of the superelement") {
  const auto grids = fe::read_grids(TITOP_DATA_DIR "/nastran_op4_superelement/outboard.asm");
  REQUIRE(grids.size() == 4);
  CHECK(grids[1].id == 11);
  CHECK(grids[1].position == Vector3d(600, 300, 300));
  CHECK(grids[1].frame.nominal().col(2) == Vector3d(1, 0, 0));  // z10 along x, x10 along y
  CHECK(grids[1].frame.nominal().col(0) == Vector3d(0, 1, 0));
  CHECK(grids[3].frame.is_identity());
}

TEST_CASE("mistakes in bulk data, with their lines") {
  refused(replaced(kText, "5.,,-1.+0", "5.,,x"), {"m.bdf:10", "'x'", "field 6"});
  refused(replaced(kText, "grid,12,3", "grid,12,7"), {"m.bdf:10", "coordinate system 7"});
  refused(replaced(kText, "CORD2R* 4               3", "CORD2R* 4               4"),
          {"m.bdf:11", "coordinate system 4", "itself"});
  refused(replaced(kText, "CORD2R  3", "CORD2C  3"), {"m.bdf:10", "CORD2C", "CORD2R"});
  refused(replaced(kText, "+A      0.      1.      2.", "+A      2.      0.      2."),
          {"coordinate system 3", "line"});
  refused(replaced(kText, "GRID    9 ", "GRID    12"), {"m.bdf:11", "'12'", "line 10"});
  refused(replaced(kText, "$ systems", "INCLUDE 'more.bdf'"), {"m.bdf:4", "INCLUDE"});
  refused(replaced(kText, "$ systems", "GRDSET          3"), {"m.bdf:4", "GRDSET"});
  refused("CBAR    3\n", {"m.bdf", "GRID", "EXTSEOUT"});
}

TEST_CASE("no data of a line are lost, and no continuation goes to another card") {
  const std::string grid = "GRID    9       10      1.      2.      3.\n";
  refused("CORD2R,10,0,0.,0.,2.,1.,0.,2.,0.,1.,2.\n" + grid, {"m.bdf:1", "'0.'", "CORD2R"});
  refused("CORD2R,10,0,0.,0.,2.,1.,0.,2.,+A,1.\n+A,0.,1.,2.\n" + grid, {"m.bdf:1", "'1.'"});
  refused("CORD2R,10,0,0.,0.,2.,1.,0.,2.\n" + grid, {"m.bdf:1", "CORD2R", "continuation"});
  CHECK(read("CORD2R,10,0,0.,0.,2.,1.,0.,2.,+A,,\n+A,0.,1.,2.\n" + grid)[0].position ==
        Vector3d(3, 1, 4));
  const std::string system =
      "CORD2R  10      0       0.      0.      2.      1.      0.      2.      ";
  CHECK(read(system + "+A\n+A      0.      1.      2.\n" + grid)[0].position == Vector3d(3, 1, 4));
  CHECK(read(system + "\n        0.      1.      2.\n" + grid)[0].position == Vector3d(3, 1, 4));
  const std::string stolen = system + "+A\n" + grid + "+A      0.      1.      2.\n";
  refused(stolen, {"m.bdf:1", "CORD2R", "continuation"});
  refused(stolen, {"m.bdf:2", "GRID", "'A'"});
  refused(system + "+A\n+B      0.      1.      2.\n" + grid, {"m.bdf:1", "'A'", "'B'"});
  refused(
      "GRID*   9                               1.              2.              *A\n"
      "CBAR    1\n*A      3.\n",
      {"m.bdf:1", "GRID", "continuation"});
}

TEST_CASE("systems in systems: 1000 of them, no more") {
  const auto nested = [](int count) {  // each one 1 m above the last
    std::string text;
    for (int i = 1; i <= count; ++i)
      text += "CORD2R," + std::to_string(i) + "," + std::to_string(i - 1) +
              ",0.,0.,1.,0.,0.,2.\n,1.,0.,1.\n";
    return text + "GRID,1," + std::to_string(count) + ",,,1.\n";
  };
  CHECK(read(nested(1000))[0].position == Vector3d(0, 0, 1001));
  refused(nested(1001), {"m.bdf:2003", "coordinate system 1", "1000"});
  refused(nested(100'001), {"coordinate system", "1000"});
}
