// The commands that analyse a diagram: margins, simulate, sweep, reduce, and --set.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/titop.hpp>

#include "app/shell.hpp"
#include "support/names.hpp"

using namespace titop;
using namespace titop_test;
using app_test::has;
using app_test::Run;

namespace {

/// m = 2 kg on k and c at a wall, force u; and a loop L = K / (s (s + 1)^2) at the point "law".
class Shell : public app_test::Shell {
 public:
  Shell() {
    Diagram d{"mass"};
    const Param k = d.param("k", 8), c = d.param("c", 0.4);
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = k, .damping = c});
    ground(z);
    z.child.force += d.input("u");
    d.output("x") = z.position;
    write_diagram(d, folder.path / "mass.json");

    Diagram loop{"loop"};
    const Param gain = loop.param("K", 1);
    auto plant =
        loop.add("plant", Lti{.A = (Eigen::Matrix3d() << -1, 1, 0, 0, -1, 1, 0, 0, 0).finished(),
                              .B = Eigen::Vector3d(0, 0, 1),
                              .C = Eigen::RowVector3d(1, 0, 0)});
    auto r = loop.input("r");
    plant.in = -1 * loop.loop_point("law", gain * plant.out) + r;
    loop.output("y") = plant.out;
    write_diagram(loop, folder.path / "loop.json");
  }
  /// Lines of a CSV file, as numbers; the first, of names, is left out.
  std::vector<std::vector<double>> numbers(const std::string& file) const {
    std::vector<std::vector<double>> rows;
    std::istringstream lines(folder.read(file));
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) {
      std::istringstream fields(line);
      rows.emplace_back();
      for (std::string field; std::getline(fields, field, ',');)
        rows.back().push_back(std::stod(field));
    }
    return rows;
  }
  std::string names(const std::string& file) const {
    const std::string text = folder.read(file);
    return text.substr(0, text.find('\n'));
  }
};

/// 1e-12 of the size.
bool near(double a, double b, double size) { return std::abs(a - b) <= 1e-12 * size; }

}  // namespace

TEST_CASE("sweep: poles of a mass on a spring at every row, and a part of the rows") {
  const Shell shell;
  shell.folder.write("points.csv", "# stiffness\nk, c\n8, 0.4\n18,0.6\n\n32, 0\n");
  Run r = shell.titop("sweep mass.json points.csv poles.csv");
  CHECK(r.code == 0);
  CHECK(r.out.empty());
  CHECK(shell.names("poles.csv") == "point,k,c,pole_hertz,pole_damping,pole_re,pole_im");
  const auto rows = shell.numbers("poles.csv");
  REQUIRE(rows.size() == 3);
  const double k[] = {8, 18, 32}, c[] = {0.4, 0.6, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double>& row = rows[i];
    REQUIRE(row.size() == 7);
    CHECK(row[0] == static_cast<double>(i + 1));
    CHECK(row[1] == k[i]);
    CHECK(row[2] == c[i]);
    const double omega = std::sqrt(k[i] / 2), xi = c[i] / (2 * 2 * omega);
    CHECK(near(row[3], omega / (2 * std::numbers::pi), row[3]));
    CHECK(near(row[4], xi, 1));
    CHECK(near(row[5], -xi * omega, omega));
    CHECK(near(std::abs(row[6]), omega * std::sqrt(1 - xi * xi), omega));
  }
  r = shell.titop("sweep mass.json points.csv second.csv --part 2/2");
  CHECK(r.code == 0);
  const auto second = shell.numbers("second.csv");
  REQUIRE(second.size() == 2);
  CHECK(second[0] == rows[1]);
  CHECK(second[1] == rows[2]);
}

TEST_CASE("sweep: a row that is refused is reported with its line, and leaves the others") {
  const Shell shell;
  // With a byte-order mark and a name in quotation marks, as spreadsheets write them.
  shell.folder.write("points.csv", "\xEF\xBB\xBF\"k\"\r\n8\r\n0\r\n50\r\n");
  // 2 rad/s is the pole of k = 8.
  const Run r = shell.titop("sweep mass.json points.csv g.csv --set c=0 --omega 2 3 2");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"points.csv:2", "singular"}));
  CHECK(shell.numbers("g.csv").size() == 4);
}

TEST_CASE("sweep: frequency responses at every row") {
  const Shell shell;
  shell.folder.write("points.csv", "k\n8\n18\n");
  const Run r = shell.titop("sweep mass.json points.csv g.csv --omega 1 4 2");
  CHECK(r.code == 0);
  CHECK(shell.names("g.csv") == "point,k,rad_per_s,re(x/u),im(x/u)");
  const auto rows = shell.numbers("g.csv");
  REQUIRE(rows.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double k = i < 2 ? 8 : 18, w = i % 2 ? 4 : 1;
    const std::complex<double> g = 1.0 / std::complex<double>(k - 2 * w * w, 0.4 * w);
    CHECK(rows[i][2] == w);
    CHECK(near(rows[i][3], g.real(), std::abs(g)));
    CHECK(near(rows[i][4], g.imag(), std::abs(g)));
  }
}

TEST_CASE("simulate: a step and a record of the force, by hand") {
  const Shell shell;
  Run r = shell.titop("simulate mass.json x.csv --set c=0 --unit-step u --step 0.25 --until 5");
  CHECK(r.code == 0);
  CHECK(has_names(r.out, {"21", "exact"}));
  CHECK(shell.names("x.csv") == "time,x");
  auto rows = shell.numbers("x.csv");
  REQUIRE(rows.size() == 21);
  for (const auto& row : rows)  // x = (1 - cos(w t)) / k, w = 2 rad/s
    CHECK(near(row[1], (1 - std::cos(2 * row[0])) / 8, 1));
  shell.folder.write("u.csv", "time,u\n0,0\n5,10\n");  // u = 2 t
  r = shell.titop("simulate mass.json ramp.csv --set c=0 --record u.csv --step 0.25 --until 5");
  CHECK(r.code == 0);
  rows = shell.numbers("ramp.csv");
  REQUIRE(rows.size() == 21);
  for (const auto& row : rows) CHECK(near(row[1], (2 * row[0] - std::sin(2 * row[0])) / 8, 10));
}

TEST_CASE("simulate: a record of the time alone, if the diagram has no inputs") {
  const Shell shell;
  Diagram d{"free"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  ground(z);
  z.child.force = 0;
  d.output("x") = z.position;
  write_diagram(d, shell.folder.path / "free.json");
  shell.folder.write("time.csv", "time\n0\n2\n");
  CHECK(shell.titop("simulate free.json x.csv --record time.csv --step 1 --until 2").code == 0);
  for (const auto& row : shell.numbers("x.csv")) CHECK(row[1] == 0);
}

TEST_CASE("margins: of K / (s (s + 1)^2), whose gain margin is 2 / K at 1 rad/s") {
  const Shell shell;
  Run r = shell.titop("margins loop.json");
  CHECK(r.code == 0);
  CHECK(has_line(r.out, {"+6.02", "1"}));
  r = shell.titop("margins loop.json --set K=0.5");
  CHECK(has_line(r.out, {"+12.04", "1"}));
  r = shell.titop("margins loop.json --set K=3");
  CHECK(r.code == 3);
  CHECK(!has(r.out, "dB"));
  // |L| = 1 at 0.6823 rad/s, 21.39 degrees ahead of -1, which a delay of 0.5471 s takes.
  CHECK(shell.titop("margins loop.json --delay 0.54").code == 0);
  CHECK(shell.titop("margins loop.json --delay 0.55").code == 3);
  r = shell.titop("margins mass.json");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"unknown-name", "mass.json", "LoopPoint"}));
}

TEST_CASE("reduce: the model, its bound and generated code") {
  const Shell shell;
  Run r = shell.titop("reduce mass.json small.m --band 0 2");
  CHECK(r.code == 0);
  CHECK(r.out == to_string(compile(read_diagram(shell.folder.path / "mass.json"),
                                   Scene{.band_hz = {0, 2}})));
  std::filesystem::create_directory(shell.folder.path / "expected");
  write_matlab(compile(read_diagram(shell.folder.path / "mass.json"), Scene{.band_hz = {0, 2}})
                   .state_space(),
               shell.folder.path / "expected" / "small.m");
  CHECK(shell.folder.read("small.m") == shell.folder.read("expected/small.m"));
  r = shell.titop("reduce mass.json small.m --band 0 2 --accuracy 1e-6");
  CHECK(r.out == to_string(compile(read_diagram(shell.folder.path / "mass.json"),
                                   Scene{.band_hz = {0, 2}, .accuracy = 1e-6})));
  r = shell.titop(
      "reduce mass.json small.hpp --band 0 2 --inputs u --outputs x --sample-time 0.01");
  CHECK(r.code == 0);
  CHECK(has(shell.folder.read("small.hpp"), "namespace small"));
  CHECK(has(shell.folder.read("small_test.cpp"), "small.hpp"));
  r = shell.titop("reduce mass.json small.m --band 0 2 --inputs force");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"unknown-name", "force", "u"}));
}

TEST_CASE("reduce: names with commas and quotation marks, as in CSV files") {
  const Shell shell;
  Diagram d{"names"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8, .damping = 0.4});
  ground(z);
  z.child.force += d.input("a,b") + d.input("u") + d.input("c");
  d.output("x, \"y\"") = z.position;
  d.output("v") = z.child.rate;
  write_diagram(d, shell.folder.path / "names.json");
  const Scene scene{.inputs = {"a,b", "u"}, .outputs = {"x, \"y\""}, .band_hz = {0, 2}};
  const std::string expected =
      to_string(compile(read_diagram(shell.folder.path / "names.json"), scene));
  const Run r = shell.titop(R"(reduce names.json small.m --band 0 2 --inputs '"a,b", u' )"
                            R"(--outputs '"x, ""y"""')");
  CHECK(r.code == 0);
  CHECK(r.out == expected);
  const Run without = shell.titop("reduce names.json small.m --band 0 2 --inputs a,b");
  CHECK(without.code == 1);
  CHECK(has_names(without.err, {"unknown-name", "a,b"}));
}

TEST_CASE("--set: the value of a parameter in every command; --version") {
  const Shell shell;
  Diagram d = read_diagram(shell.folder.path / "mass.json");
  Run r = shell.titop("compile mass.json --set k=32 --set c=0");
  CHECK(r.code == 0);
  CHECK(has(r.out, to_string(compile(d).update({{"k", 32}, {"c", 0}}).poles())));
  r = shell.titop("check mass.json --set stiffness=3");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"unknown-name", "stiffness", "k", "c"}));
  r = shell.titop("--version");
  CHECK(r.code == 0);
  CHECK(r.out.rfind("titop ", 0) == 0);
}

TEST_CASE("tables and options that do not fit are refused") {
  const Shell shell;
  shell.folder.write("points.csv", "k\n8\n");
  shell.folder.write("words.csv", "k,c\n8\n9,many\n");
  shell.folder.write("empty.csv", "k\n");
  Run r = shell.titop("sweep mass.json words.csv out.csv");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"bad-file", "words.csv:2", "words.csv:3", "'many'"}));
  CHECK(shell.titop("sweep mass.json empty.csv out.csv").code == 1);
  shell.folder.write("other.csv", "mass\n8\n");
  CHECK(has_names(shell.titop("sweep mass.json other.csv out.csv").err, {"unknown-name", "mass"}));
  shell.folder.write("no_time.csv", "u\n8\n");
  CHECK(
      has_names(shell.titop("simulate mass.json o.csv --record no_time.csv --step 1 --until 2").err,
                {"bad-file", "no_time.csv", "time"}));
  shell.folder.write("only_time.csv", "time\n0\n2\n");
  r = shell.titop("simulate mass.json o.csv --record only_time.csv --step 1 --until 2");
  CHECK(r.code == 1);
  CHECK(has_names(r.err, {"bad-file", "only_time.csv", "u"}));
  for (const char* words :
       {"sweep mass.json points.csv", "sweep mass.json points.csv out.txt",
        "sweep mass.json points.csv points.csv", "sweep mass.json mass.json out.csv",
        "margins loop.json -d 0.1", "simulate mass.json o.csv --record --step 1 --until 2",
        "simulate mass.json o.csv --step 1 --until 2 --unit-step u --record points.csv",
        "margins loop.json --set K=1 --set K=2", "sweep mass.json points.csv out.csv --part 3/2",
        "sweep mass.json points.csv out.csv --part 2", "simulate mass.json o.csv --unit-step u",
        "simulate mass.json o.csv --step 1 --until 2", "reduce mass.json small.m",
        "reduce mass.json small.json --band 0 1", "reduce mass.json s.m --band 0 1 --sample-time 1",
        "margins loop.json --set K", "margins loop.json --set K=fast",
        "import mass.json --set k=1"}) {
    INFO(words);
    r = shell.titop(words);
    CHECK(r.code == 2);
    CHECK(r.err.rfind("titop: ", 0) == 0);
  }
}
