#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <string>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/graph/error.hpp>

#include "support/refused.hpp"

/// Broken files: each is refused, with file, line, the text found and the text expected.

using namespace titop;
using titop_test::replaced;

namespace {

/// A small correct set: one solid node 1 and a rigid body (2 with rotations in 3), nine rows.
struct Files {
  std::string sti, mas, dof, inp;
};

Files good() {
  Files f;
  for (const char* node : {"1", "2", "3"})
    for (const char* dof : {".1\n", ".2\n", ".3\n"}) f.dof += std::string(node) + dof;
  for (int j = 1; j <= 9; ++j)
    for (int i = 1; i <= j; ++i) {
      const std::string at = std::to_string(i) + " " + std::to_string(j);
      f.sti += at + (i == j ? "  4.0000000000000e+00\n" : " -1.0000000000000e-01\n");
      f.mas += at + (i == j ? "  1.5000000000000e+00\n" : "  0.0000000000000e+00\n");
    }
  f.inp =
      "** a comment\n"
      "*Node, nset=all\n"
      "1, 0.5, 0, 1e-1\n"
      "2,1,0,0,\n"
      "\n"
      "*NSET,NSET=FACE\n"
      "1,\n"
      "*Rigid Body, Nset=FACE, Ref Node=2,\n"
      "Rot Node=3\n";
  return f;
}

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("titop_calculix_broken_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  fe::Mesh read(const Files& f) const {
    write("b.sti", f.sti);
    write("b.mas", f.mas);
    write("b.dof", f.dof);
    write("b.inp", f.inp);
    return fe::read_calculix(fe::calculix_files(path_ / "b"), {{"C", 2}});
  }

 private:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  std::filesystem::path path_;
};

/// The text of the error that reading gives.
std::string message(const Files& f) {
  try {
    Folder().read(f);
  } catch (const Error& error) {
    CHECK((error.has(Code::bad_file) || error.has(Code::unknown_name)));
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("the small set is read") {
  const fe::Mesh mesh = Folder().read(good());
  CHECK(mesh.points.size() == 2);
  CHECK(fe::dof_name(mesh, 8) == "C.rz");
  CHECK(mesh.points[0].position == Vector3d(0.5, 0, 0.1));
  CHECK(mesh.K(0, 8) == -0.1);
  CHECK(mesh.K(8, 0) == -0.1);
  CHECK(mesh.M(3, 3) == 1.5);
}

TEST_CASE("a matrix file with something else than numbers") {
  Files f = good();
  f.sti = replaced(f.sti, "2 2  4.0000000000000e+00", "2 2  4.000x0000000000e+00");
  CHECK(message(f) ==
        "error[bad-file]: b.sti:3: found '2 2  4.000x0000000000e+00', expected row, column and a "
        "finite value");
  f = good();
  f.mas = replaced(f.mas, "2 2 ", "2 b ");
  CHECK(message(f).find("b.mas:3: found '2 b  1.5") != std::string::npos);
  f = good();
  f.mas = replaced(f.mas, "1 2  0.0000000000000e+00", "1 2  nan");
  CHECK(message(f).find("b.mas:2: found '1 2  nan', expected row, column and a finite value") !=
        std::string::npos);
  f.mas = replaced(f.mas, "nan", "1e999");
  CHECK(message(f).find("b.mas:2: found '1 2  1e999'") != std::string::npos);
  f.mas = replaced(f.mas, "1e999", "1,5");  // a decimal comma
  CHECK(message(f).find("b.mas:2: found '1 2  1,5'") != std::string::npos);
  f.mas = replaced(f.mas, "1,5", "0 7");
  CHECK(message(f).find("b.mas:2: found '1 2  0 7'") != std::string::npos);
  f.mas = replaced(f.mas, "1 2  0 7\n", "\n");
  CHECK(message(f).find("b.mas:2: found '', expected") != std::string::npos);
}

TEST_CASE("an index outside the rows") {
  Files f = good();
  f.sti = replaced(f.sti, "9 9 ", "9 10 ");
  CHECK(message(f) ==
        "error[bad-file]: b.sti:45: found '9 10  4.0000000000000e+00', expected row and column "
        "from 1 to 9, the lines of the .dof file");
  f = good();
  f.mas = replaced(f.mas, "1 1 ", "0 1 ");
  CHECK(message(f).find("b.mas:1: found '0 1  1.5") != std::string::npos);
}

TEST_CASE("a missing row, a missing label") {
  Files f = good();
  f.mas = replaced(f.mas, "5 5  1.5000000000000e+00\n", "");
  CHECK(message(f) ==
        "error[bad-file]: b.mas:44: found the end of the file and no entry (5, 5) (dof 2.2), "
        "expected a diagonal entry for each of the 9 rows");
  f = good();
  f.dof = replaced(f.dof, "3.3\n", "");
  CHECK(message(f).find("b.sti:37: found '1 9 -1.0000000000000e-01', expected row and column from "
                        "1 to 8") != std::string::npos);
  f = good();
  f.dof += "4.1\n";
  CHECK(message(f).find("b.dof:10: found 4.1, expected a node of b.inp, which has no position of "
                        "node 4") != std::string::npos);
}

TEST_CASE("duplicates") {
  Files f = good();
  f.sti += "1 2 -2.0e-01\n";
  CHECK(message(f) ==
        "error[bad-file]: b.sti:46: found '1 2 -2.0e-01', expected the value -0.1 that (1, 2) "
        "already has");
  f = good();
  f.sti += "2 1 -2.0e-01\n";  // the other triangle
  CHECK(message(f).find("b.sti:46: found '2 1 -2.0e-01', expected the value -0.1") !=
        std::string::npos);
  f = good();
  f.sti += "2 1 -1.0e-01\n";  // the same value
  CHECK(message(f) == "no error");
  f = good();
  f.dof = replaced(f.dof, "1.2\n", "1.1\n");
  CHECK(message(f) ==
        "error[bad-file]: b.dof:2: found 1.1 again, expected a label once: line 1 has it");
}

TEST_CASE("empty, missing and truncated files") {
  Files f = good();
  f.mas.clear();
  CHECK(message(f).find("b.mas: the file is empty") != std::string::npos);
  f = good();
  f.sti.resize(f.sti.size() - 20);  // "9 9  " and no value
  CHECK(message(f).find("b.sti:45: found '9 9  ' without line end") != std::string::npos);
  f = good();
  f.sti.resize(f.sti.size() - 5);  // "4.0000000000000" is a number too
  CHECK(message(f) ==
        "error[bad-file]: b.sti:45: found '9 9  4.0000000000000' without line end, expected a line "
        "end: the file may be truncated (add one if it is complete)");
  f = good();
  f.sti = f.sti.substr(0, f.sti.find("1 9 "));
  CHECK(message(f).find("b.sti:36: found the end of the file and no entry (9, 9)") !=
        std::string::npos);
  try {
    fe::read_calculix(fe::calculix_files("nowhere/beam"));
    CHECK(false);
  } catch (const Error& error) {
    CHECK(
        std::string(error.what())
            .starts_with("error[bad-file]: nowhere/beam.dof: cannot be opened\n  check the path"));
  }
}

TEST_CASE("labels that mean nothing") {
  Files f = good();
  for (const std::string label : {"1.4", "1.0", "12", "a.1", "-1.1", "1.1.1", ""}) {
    Files g = f;
    g.dof = replaced(g.dof, "1.2\n", label + "\n");
    INFO(label);
    CHECK(message(g) ==
          "error[bad-file]: b.dof:2: found '" + label + "', expected node.dof with dof 1, 2 or 3");
  }
}

TEST_CASE("decks that cannot be read safely") {
  Files f = good();
  f.inp = replaced(f.inp, "1, 0.5, 0, 1e-1", "1, 0.5, 0");
  CHECK(message(f).find("b.inp:3: found '1, 0.5, 0', expected node, x, y, z with finite numbers") !=
        std::string::npos);
  f = good();
  f.inp = replaced(f.inp, "2,1,0,0,\n", "2,1,0,0,\n1,0,0,0\n");
  CHECK(message(f) ==
        "error[bad-file]: b.inp:5: found '1,0,0,0', expected one position per node: node 1 was at "
        "0.5, 0, 0.1");
  f = good();
  f.inp += "*INCLUDE, INPUT=more.inp\n";
  CHECK(message(f).find("b.inp:10: found *INCLUDE, expected the included lines") !=
        std::string::npos);
  f = good();
  f.inp = replaced(f.inp, "*Node, nset=all", "*Node, system=C");
  CHECK(message(f).find("b.inp:2: found *NODE parameter SYSTEM, expected NSET only") !=
        std::string::npos);
  f = good();
  f.inp = replaced(f.inp, ",\nRot Node=3", "");
  CHECK(message(f).find("b.inp:8: found a *RIGID BODY without ROT NODE") != std::string::npos);
  f = good();
  f.inp += "*RIGID BODY, NSET=FACE, REF NODE=1, ROT NODE=3\n";
  CHECK(message(f).find("b.inp:10: found nodes 1 and 3, of which line 8 uses one") !=
        std::string::npos);
  f = good();
  f.inp = "*STEP\n";
  CHECK(message(f) ==
        "error[bad-file]: b.inp: found no *NODE with positions, expected the deck of the matrices");
  f = good();
  f.inp = replaced(f.inp, "2,1,0,0,\n", "");
  CHECK(message(f).find("b.dof:4: found 2.1, expected a node of b.inp, which has no position of "
                        "node 2") != std::string::npos);
}

TEST_CASE("several mistakes come together, the rest is counted") {
  Files f = good();
  f.sti.clear();
  for (int i = 0; i < 30; ++i) f.sti += "x\n";
  const std::string text = message(f);
  CHECK(text.find("b.sti:1: ") != std::string::npos);
  CHECK(text.find("b.sti:20: ") != std::string::npos);
  CHECK(text.find("b.sti:21: ") == std::string::npos);
  CHECK(text.find("and 10 more like these") != std::string::npos);
}

TEST_CASE("an interface that is not there") {
  const Folder folder;
  folder.read(good());
  try {
    fe::read_calculix(
        fe::calculix_files(std::filesystem::temp_directory_path() /
                           ("titop_calculix_broken_" + std::to_string(getpid())) / "b"),
        {{"P", 3}});
    CHECK(false);
  } catch (const Error& error) {
    CHECK(error.has(Code::unknown_name));
    CHECK(std::string(error.what()) ==
          "error[unknown-name]: interface P of mesh b: node 3 has no row in the matrices\n"
          "  the reference nodes of the deck's rigid bodies are 2");
  }
}
