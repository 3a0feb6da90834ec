// Input that is legal but rarely meant is told of with its number; broken files are told apart.
#include <doctest/doctest.h>

#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/modal_csv.hpp>
#include <titop/graph/error.hpp>

#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using titop_test::check_refused;
using titop_test::Folder;
using titop_test::has_names;

namespace {

Beam boom() {
  return {.length = 2.0,
          .section = rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = 2};
}

}  // namespace

TEST_CASE("a usual beam has no warning; damping in percent and other units have one each") {
  CHECK(implausible(boom()).empty());
  ModalData data = modal_data(boom());
  CHECK(implausible(data).empty());
  data.xi(2) = 0.5;
  REQUIRE(implausible(data).size() == 1);
  CHECK(has_names(implausible(data)[0], {"0.5", "mode 3", "0.2"}));
  CHECK(titop_test::has_line(to_string(modal_report(data)), {"warning", "0.5", "mode 3"}));
  data.xi.setZero();
  data.omega /= 1e8;
  REQUIRE(implausible(data).size() == 1);
  CHECK(has_names(implausible(data)[0], {"0.0001 Hz"}));
  data.omega *= 1e16;
  CHECK(has_names(implausible(data).at(0), {"1e+06 Hz"}));
  Beam soft = boom();
  soft.material.E = 70e3;  // MPa
  CHECK(has_names(implausible(soft).at(0), {"7e+04 Pa", "1e+08 Pa"}));
}

TEST_CASE("centre of mass of M against that of the points; units of the mesh") {
  fe::Mesh mesh = beam_mesh(boom());
  CHECK(fe::implausible(fe::mesh_report(mesh)).empty());
  // 5 kg, 1 m beside the tip: the beam of 12.96 kg has its centre 5 / 17.96 m off the points' one.
  mesh.M.bottomRightCorner(6, 6) += rigid_mass(5, Matrix3d::Zero(), {0, 1, 0});
  const std::vector<std::string> lines = fe::implausible(fe::mesh_report(mesh));
  REQUIRE(lines.size() == 1);
  CHECK(has_names(lines[0], {"0.278"}));

  // 2700 kg/m^3 times 0.06 m times 0.04 m times 2 m, and the same in mm.
  const fe::Mesh metres = beam_mesh(boom());
  fe::Mesh millimetres = metres;
  for (fe::MeshPoint& p : millimetres.points) p.position *= 1000;
  for (Eigen::Index i = 0; i < 18; ++i)
    for (Eigen::Index j = 0; j < 18; ++j)
      millimetres.M(i, j) *= (i % 6 > 2 ? 1000.0 : 1.0) * (j % 6 > 2 ? 1000.0 : 1.0);
  const std::string plain = to_string(fe::mesh_report(millimetres));
  CHECK(titop_test::has_line(plain, {"12.96", "1000"}));
  CHECK(plain.find(" kg") == std::string::npos);
  const std::string si = to_string(fe::mesh_report(millimetres), DataUnits{.length = 1e-3});
  CHECK(titop_test::has_line(si, {"12.96 kg"}));
  // Craig-Bampton: the mass is not at the points.
  fe::Mesh reduced = metres;
  reduced.points.push_back({"mode", Vector3d::Zero()});
  reduced.dofs.push_back({3, fe::kGeneralised});
  for (Eigen::MatrixXd* S : {&reduced.K, &reduced.M}) {
    S->conservativeResize(19, 19);
    S->rightCols(1).setZero(), S->bottomRows(1).setZero();
    (*S)(18, 18) = 1;
  }
  CHECK(!fe::mesh_report(reduced).geometry);
}

TEST_CASE("CalculiX: nodes of couplings and beams are explained; E in MPa is told of") {
  const Folder folder;
  folder.write("b.inp",
               "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n"
               "*COUPLING, REF NODE=1, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n"
               "*MATERIAL, NAME=M\n*ELASTIC\n70000., 0.33\n*ELASTIC, TYPE=ORTHO\n1., 2., 3.\n");
  folder.write("b.dof", "1.1\n7.1\n8.1\n");
  folder.write("b.sti", "1 1 1.0\n");
  folder.write("b.mas", "1 1 1.0\n");
  check_refused([&] { fe::read_calculix(fe::calculix_files(folder.path / "b")); }, Code::bad_file,
                {"b.dof:2", "7.1", "*COUPLING", "B31", "*RIGID BODY"});
  const fe::CalculixDeck deck = fe::read_calculix_deck(folder.path / "b.inp");
  REQUIRE(deck.least_E);
  CHECK(*deck.least_E == 70000);
  CHECK(has_names(fe::implausible(deck).at(0), {"7e+04 Pa"}));
}

TEST_CASE("a binary file given to a reader of text is told so in full") {
  const std::string op4 = TITOP_DATA_DIR "/nastran_op4_superelement/outboard.op4";
  check_refused([&] { fe::read_modal_csv(op4); }, Code::bad_file,
                {"outboard.op4", "NUL", "read_op4"});
  check_refused([&] { fe::read_dmig(op4, "K", "M"); }, Code::bad_file, {"NUL"});
  const Folder folder;
  folder.write("m.csv", "mo\1de, 1\n");
  check_refused([&] { fe::read_modal_csv(folder.path / "m.csv"); }, Code::bad_file,
                {"m.csv:1", "'mo?de'", "D_P"});
}
