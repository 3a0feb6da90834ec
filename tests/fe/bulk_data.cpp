// Positions and frames from bulk data: fields of 8 and 16 columns and free ones, systems in
// systems, the real .asm, and refusals.
#include <doctest/doctest.h>

#include <cmath>
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

TEST_CASE("cylindrical and spherical systems: positions and directions of displacements") {
  // System 5 is that of kText's 3: its x, y, z along the basic y, z, x, from (0, 0, 2).
  const std::string card = ",5,0,0.,0.,2.,1.,0.,2.,+A\n+A,0.,1.,2.\n";
  const auto in_basic = [](double x, double y, double z) { return Vector3d(z, x, 2 + y); };
  // r = 2, theta = 30 degrees, z = 5.
  const fe::Grid c = read("CORD2C" + card + "GRID,1,5,2.,30.,5.,5\n")[0];
  const double s3 = std::sqrt(3);
  CHECK((c.position - in_basic(s3, 1, 5)).norm() <= 1e-15 * 6);
  Matrix3d T;
  T << in_basic(s3 / 2, 0.5, 0), in_basic(-0.5, s3 / 2, 0), in_basic(0, 0, 1);
  T.row(2).array() -= 2;
  CHECK((c.frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
  // r = 2, theta = 60 degrees from z, phi = 30 degrees.
  const fe::Grid s = read("CORD2S" + card + "GRID,1,5,2.,60.,30.,5\n")[0];
  CHECK((s.position - in_basic(1.5, s3 / 2, 1)).norm() <= 1e-15 * 4);
  T << in_basic(0.75, s3 / 4, 0.5), in_basic(s3 / 4, 0.25, -s3 / 2), in_basic(-0.5, s3 / 2, 0);
  T.row(2).array() -= 2;
  CHECK((s.frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
  // On the axis the directions of a cylinder are not defined: those of the system.
  const fe::Grid axis = read("CORD2C" + card + "GRID,1,,7.,0.,2.,5\n")[0];
  CHECK(axis.frame.nominal() == read("CORD2R" + card + "GRID,1,,7.,0.,2.,5\n")[0].frame.nominal());
  // Points of a system in a cylindrical one: A at r = 1, theta = 90 degrees.
  const fe::Grid in =
      read("CORD2C" + card +
           "CORD2R,6,5,1.,90.,0.,1.,90.,1.,+B\n+B,2.,90.,0.\nGRID,1,6,1.,2.,3.,6\n")[0];
  CHECK((in.position - in_basic(-2, 2, 3)).norm() <= 1e-15 * 4);
}

TEST_CASE("systems by three grids, two in one card") {
  const std::string grids = "GRID,1,,0.,0.,2.\nGRID,2,,1.,0.,2.\nGRID,3,,0.,1.,2.\n";
  const auto last = [&](const std::string& text) { return read(grids + text).back(); };
  const fe::Grid by_points =
      read("CORD2C,5,0,0.,0.,2.,1.,0.,2.,+A\n+A,0.,1.,2.\nGRID,9,5,2.,30.,5.,5\n")[0];
  for (const char* cards : {"CORD1C,5,1,2,3\n", "CORD1C,4,2,1,3,5,1,2,3\n"}) {
    const fe::Grid g = last(std::string(cards) + "GRID,9,5,2.,30.,5.,5\n");
    CHECK((g.position - by_points.position).norm() <= 1e-15 * 6);
    CHECK((g.frame.nominal() - by_points.frame.nominal()).cwiseAbs().maxCoeff() <= 1e-15);
  }
  CHECK((last("CORD1R,5,1,2,3\nGRID,9,5,1.,2.,3.\n").position - Vector3d(3, 1, 4)).norm() <= 1e-15);
  CHECK((last("CORD1S,5,1,2,3\nGRID,9,5,2.,90.,90.\n").position - Vector3d(0, 0, 4)).norm() <=
        1e-15 * 4);
}

TEST_CASE("mistakes in bulk data, with their lines") {
  refused(replaced(kText, "5.,,-1.+0", "5.,,x"), {"m.bdf:10", "'x'", "field 6"});
  refused(replaced(kText, "grid,12,3", "grid,12,7"), {"m.bdf:10", "coordinate system 7"});
  refused(replaced(kText, "CORD2R* 4               3", "CORD2R* 4               4"),
          {"m.bdf:11", "coordinate system 4", "itself"});
  // The third point is three times the second, up to rounding.
  refused("CORD2R,10,0,0.,0.,0.,0.1,0.2,0.3,+A\n+A,0.3,0.6,0.9\nGRID,1,10,1.,0.,0.\n",
          {"m.bdf", "coordinate system 10", "on a line"});
  refused(replaced(kText, "CORD2R  3", "CORD3G  3"), {"m.bdf:10", "CORD3G", "CORD2R"});
  refused("CORD1R,5,1,2,3\nGRID,1\nGRID,2,,,,1.\nGRID,9,5\n",
          {"m.bdf:4", "grid 3 of coordinate system 5"});
  refused("CORD1R,5,1,2,3\nGRID,1\nGRID,2,,,,1.\nGRID,3,5,1.\nGRID,9,5\n",
          {"m.bdf:4", "coordinate system 5", "itself"});
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
  refused("GRID\t9\t0\t1.\t2.\t3.\n", {"m.bdf:1", "a tab in GRID", "columns"});
  CHECK(read("GRID,\t9,0,\t1.,2.,3.\n")[0].position == Vector3d(1, 2, 3));
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
