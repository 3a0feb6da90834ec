// titop import: the report, a body as a diagram and as CSV, exit codes.
#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "app/shell.hpp"
#include "support/names.hpp"

using namespace titop;
using app_test::Run;
using titop_test::has_line;
using titop_test::has_names;

namespace {

const std::string kOp4 = TITOP_DATA_DIR "/nastran_op4_superelement/outboard.op4";

}  // namespace

TEST_CASE("import: the contents of the file, then a diagram of the body and its CSV") {
  const app_test::Shell shell;
  Run r = shell.titop("import " + kOp4 + " --units 1e-3 1 1");
  CHECK(r.code == 0);
  CHECK(r.err.empty());
  CHECK(r.out == fe::import_body(kOp4, {.units = {.length = 1e-3}}).text);
  CHECK(has_line(r.out, {"ports", "3, 11, 19, 27"}));

  const std::string body =
      "import " + kOp4 + " --units 1e-3 1 1 --parent 3 --children 11,27 --modes 5 --xi 0.005";
  r = shell.titop(body + " -o body.json");
  CHECK(r.code == 0);
  const fe::Import expected =
      fe::import_body(kOp4, {.parent = "3",
                             .children = {"11", "27"},
                             .units = {.length = 1e-3},
                             .modes = {.kept = 5, .residual = {"11", "27", "3"}, .xi = {0.005}}});
  REQUIRE(expected.body);
  CHECK(r.out == expected.text);
  r = shell.titop("check body.json");
  CHECK(r.code == 0);
  CHECK(has_names(r.out, {"18 inputs", "18 outputs"}));
  CHECK(diagram_json(read_diagram(shell.folder.path / "body.json")) ==
        diagram_json(diagram_of_body(*expected.body)));

  r = shell.titop(body + " -o body.csv");
  CHECK(r.code == 0);
  CHECK(fe::read_modal_csv(shell.folder.path / "body.csv").omega == expected.body->omega);
}

TEST_CASE("import: a planar model takes the mass of the whole body") {
  const app_test::Shell shell;
  const auto card = [](const std::string& name, int j, int cj, int i, int ci, double value) {
    const auto field = [](const std::string& text) {
      return text + std::string(8 - text.size(), ' ');
    };
    const auto number = [&](double x) {
      const std::string text = std::to_string(x);
      return field(text.substr(0, 8));
    };
    return field("DMIG") + field(name) + field(std::to_string(j)) + field(std::to_string(cj)) +
           field("") + field(std::to_string(i)) + field(std::to_string(ci)) + number(value) + "\n";
  };
  // Two points on a rod along x that moves along x only: 3 kg each, 200 N/m between them.
  shell.folder.write("rod.pch", "DMIG    KAAX    0       6       2       0\n" +
                                    card("KAAX", 1, 1, 1, 1, 200) + card("KAAX", 2, 1, 1, 1, -200) +
                                    card("KAAX", 2, 1, 2, 1, 200) +
                                    "DMIG    MAAX    0       6       2       0\n" +
                                    card("MAAX", 1, 1, 1, 1, 3) + card("MAAX", 2, 1, 2, 1, 3));
  Run r = shell.titop("import rod.pch --parent 1 --children 2 -o rod.json");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"y, z, rx, ry, rz", "ModeOptions::rigid", "--mass"}));
  r = shell.titop("import rod.pch --parent 1 --children 2 --mass 6 0.5 0 0 1 2 3 -o rod.json");
  CHECK(r.code == 0);
  CHECK(shell.titop("check rod.json").code == 0);
  r = shell.titop("import rod.pch --parent 1 --children 2 --mass 60 0.5 0 0 1 2 3 -o rod.json");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"60", "6", "x, x", "ModeOptions::rigid"}));
}

TEST_CASE("import: unknown options and refused files") {
  const app_test::Shell shell;
  CHECK(shell.titop("import " + kOp4 + " -o body.json").code == 2);  // no parent
  CHECK(shell.titop("import " + kOp4 + " --parent 3 -o body.txt").code == 2);
  CHECK(shell.titop("import " + kOp4 + " --matrices KXX").code == 2);
  CHECK(shell.titop("import " + kOp4 + " --omega 1 2 3").code == 2);
  const Run r = shell.titop("import nothing.op4");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"nothing.op4"}));
  const std::string cantilever = TITOP_DATA_DIR "/nastran_cantilever/";
  const Run tip =
      shell.titop("import " + cantilever + "pn_mwe_s-solution_1.op2 --parent 3 --children 5");
  CHECK(tip.code == 1);
  CHECK(has_names(tip.err, {"grid 3", "SPC1"}));
  const Run twice = shell.titop("import " + cantilever + "cantilever.csv --units 1e-3 1 1 --xi 1");
  CHECK(twice.code == 1);
  CHECK(has_names(twice.err, {"cantilever.csv", "--units", "--xi"}));
  CHECK(app_test::has(shell.titop("--help").out, "OP4, OP2, f06, DMIG"));
}
