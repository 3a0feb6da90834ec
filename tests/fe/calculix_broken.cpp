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

/// Reading is refused with these names and numbers.
void refused(const Files& f, std::initializer_list<std::string_view> names) {
  titop_test::check_refused([&] { Folder().read(f); }, Code::bad_file, names);
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
  refused(f, {"b.sti:3", "'2 2  4.000x0000000000e+00'"});
  f = good();
  f.mas = replaced(f.mas, "2 2 ", "2 b ");
  refused(f, {"b.mas:3", "'2 b  1.5000000000000e+00'"});
  f = good();
  f.mas = replaced(f.mas, "1 2  0.0000000000000e+00", "1 2  nan");
  refused(f, {"b.mas:2", "'1 2  nan'"});
  f.mas = replaced(f.mas, "nan", "1e999");
  refused(f, {"b.mas:2", "'1 2  1e999'"});
  f.mas = replaced(f.mas, "1e999", "1,5");  // a decimal comma
  refused(f, {"b.mas:2", "'1 2  1,5'"});
  f.mas = replaced(f.mas, "1,5", "0 7");
  refused(f, {"b.mas:2", "'1 2  0 7'"});
  f.mas = replaced(f.mas, "1 2  0 7\n", "\n");
  refused(f, {"b.mas:2", "''"});
}

TEST_CASE("an index outside the rows") {
  Files f = good();
  f.sti = replaced(f.sti, "9 9 ", "9 10 ");
  refused(f, {"b.sti:45", "'9 10  4.0000000000000e+00'", "1", "9"});
  f = good();
  f.mas = replaced(f.mas, "1 1 ", "0 1 ");
  refused(f, {"b.mas:1", "'0 1  1.5000000000000e+00'", "1", "9"});
}

TEST_CASE("a missing row, a missing label") {
  Files f = good();
  f.mas = replaced(f.mas, "5 5  1.5000000000000e+00\n", "");
  refused(f, {"b.mas:44", "(5, 5)", "dof 2.2", "9"});
  f = good();
  f.dof = replaced(f.dof, "3.3\n", "");
  refused(f, {"b.sti:37", "'1 9 -1.0000000000000e-01'", "1", "8"});
  f = good();
  f.dof += "4.1\n";
  refused(f, {"b.dof:10", "4.1", "b.inp", "node 4"});
}

TEST_CASE("duplicates") {
  Files f = good();
  f.sti += "1 2 -2.0e-01\n";
  refused(f, {"b.sti:46", "'1 2 -2.0e-01'", "-0.1", "(1, 2)"});
  f = good();
  f.sti += "2 1 -2.0e-01\n";  // the other triangle
  refused(f, {"b.sti:46", "'2 1 -2.0e-01'", "-0.1"});
  f = good();
  f.sti += "2 1 -1.0e-01\n";  // the same value
  CHECK_NOTHROW(Folder().read(f));
  f = good();
  f.dof = replaced(f.dof, "1.2\n", "1.1\n");
  refused(f, {"b.dof:2", "1.1", "line 1"});
}

TEST_CASE("empty, missing and truncated files") {
  Files f = good();
  f.mas.clear();
  refused(f, {"b.mas"});
  f = good();
  f.sti.resize(f.sti.size() - 20);  // "9 9  " and no value
  refused(f, {"b.sti:45", "'9 9  '"});
  f = good();
  f.sti.resize(f.sti.size() - 5);  // "4.0000000000000" is a number too
  refused(f, {"b.sti:45", "'9 9  4.0000000000000'"});
  f = good();
  f.sti = f.sti.substr(0, f.sti.find("1 9 "));
  refused(f, {"b.sti:36", "(9, 9)"});
  const Error nowhere =
      titop_test::error_of([] { fe::read_calculix(fe::calculix_files("nowhere/beam")); });
  CHECK(titop_test::says(nowhere, Code::bad_file, {"nowhere/beam.dof"}));
}

TEST_CASE("labels that mean nothing") {
  Files f = good();
  for (const std::string label : {"1.4", "1.0", "12", "a.1", "-1.1", "1.1.1", ""}) {
    Files g = f;
    g.dof = replaced(g.dof, "1.2\n", label + "\n");
    INFO(label);
    refused(g, {"b.dof:2", "'" + label + "'", "node.dof", "1, 2", "3"});
  }
}

TEST_CASE("decks that cannot be read safely") {
  Files f = good();
  f.inp = replaced(f.inp, "1, 0.5, 0, 1e-1", "1, 0.5, 0");
  refused(f, {"b.inp:3", "'1, 0.5, 0'", "x, y, z"});
  f = good();
  f.inp = replaced(f.inp, "2,1,0,0,\n", "2,1,0,0,\n1,0,0,0\n");
  refused(f, {"b.inp:5", "'1,0,0,0'", "node 1", "0.5, 0, 0.1"});
  f = good();
  f.inp += "*INCLUDE, INPUT=more.inp\n";
  refused(f, {"b.inp:10", "*INCLUDE"});
  f = good();
  f.inp = replaced(f.inp, "*Node, nset=all", "*Node, system=C");
  refused(f, {"b.inp:2", "*NODE", "SYSTEM", "NSET"});
  f = good();
  f.inp = replaced(f.inp, ",\nRot Node=3", "");
  refused(f, {"b.inp:8", "*RIGID BODY", "ROT NODE"});
  f = good();
  f.inp += "*RIGID BODY, NSET=FACE, REF NODE=1, ROT NODE=3\n";
  refused(f, {"b.inp:10", "1", "3", "line 8"});
  f = good();
  f.inp = "*STEP\n";
  refused(f, {"b.inp", "*NODE"});
  f = good();
  f.inp = replaced(f.inp, "2,1,0,0,\n", "");
  refused(f, {"b.dof:4", "2.1", "b.inp", "node 2"});
}

TEST_CASE("several mistakes come together, the rest is counted") {
  Files f = good();
  f.sti.clear();
  for (int i = 0; i < 30; ++i) f.sti += "x\n";
  const Error error = titop_test::error_of([&] { Folder().read(f); });
  REQUIRE(error.mistakes().size() == 20);
  for (std::size_t i = 0; i < 20; ++i)
    CHECK(titop_test::has_name(error.mistakes()[i].message, "b.sti:" + std::to_string(i + 1)));
  REQUIRE(error.mistakes().back().details.size() == 1);
  CHECK(titop_test::has_name(error.mistakes().back().details.front(), "10"));
}

TEST_CASE("an interface that is not there") {
  const Folder folder;
  folder.read(good());
  const Error error = titop_test::error_of([] {
    fe::read_calculix(
        fe::calculix_files(std::filesystem::temp_directory_path() /
                           ("titop_calculix_broken_" + std::to_string(getpid())) / "b"),
        {{"P", 3}});
  });
  CHECK(titop_test::says(error, Code::unknown_name, {"P", "b", "node 3", "2"}));
}
