// The command line: its output, its files, its exit codes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/titop.hpp>

#include "app/masses_shell.hpp"
#include "support/names.hpp"

using namespace titop;
using namespace titop_test;
using app_test::has;
using app_test::Run;
using Shell = app_test::MassesShell;

TEST_CASE("check and compile print counts and findings") {
  const Shell shell;
  Run r = shell.titop("check masses.json");
  CHECK(r.code == 0);
  CHECK(std::count(r.out.begin(), r.out.end(), '\n') == 1);
  CHECK(has_names(r.out, {"five masses", "10", "1", "6"}));
  CHECK(r.err.empty());
  r = shell.titop("compile masses.json");
  CHECK(r.code == 0);
  const System system = compile(Shell::diagram());
  CHECK(has(r.out, to_string(system.poles())));
  CHECK(has(r.out, to_string(system.dense_certificate())));
}

TEST_CASE("certify: as text and as JSON; exit code 3 where something does not hold") {
  const Shell shell;
  Run r = shell.titop("certify masses.json -o c.json");
  CHECK(r.code == 0);
  CHECK(r.err.empty());
  const FullCertificate c = certify(compile(Shell::diagram()));
  CHECK(c.holds());
  CHECK(r.out == to_string(c));
  CHECK(shell.folder.read("c.json") == certificate_json(c));
  // A loop at 1e-12 from singular: its gain is only known to four digits.
  Diagram d{"ring"};
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  auto K = d.add("K", Gain{.gain = (1 - 1e-12) / 0.7}), G = d.add("G", Gain{.gain = 0.7});
  auto u = d.input("u");
  K.in = G.out;
  G.in = K.out + u + z.stretch;
  z.child.force += u;
  d.output("y") = G.out;
  write_diagram(d, shell.folder.path / "ring.json");
  r = shell.titop("certify ring.json -o ring.certificate.json");
  CHECK(r.code == 3);
  const auto ring = nlohmann::json::parse(shell.folder.read("ring.certificate.json"));
  CHECK(ring.at("holds") == false);
  CHECK(has_line(r.out, {"FAULT", two_digits(ring.at("grid").at("dense").get<double>())}));
  CHECK(shell.titop("certify none.json").code == 1);
  r = shell.titop("certify masses.json -o none/c.json");
  CHECK(r.code == 1);
  CHECK(has(r.err, "error[bad-file]"));
}

TEST_CASE("draw writes the text of to_dot") {
  const Shell shell;
  CHECK(shell.titop("draw masses.json a.dot").code == 0);
  CHECK(shell.folder.read("a.dot") == to_dot(Shell::diagram()));
  CHECK(shell.titop("draw --compiled masses.json b.dot").code == 0);
  CHECK(shell.folder.read("b.dot") == to_dot(compile(Shell::diagram()).stage()));
}

TEST_CASE("draw folds large diagrams on request") {
  const Shell shell;
  CHECK(shell.titop("draw --fold 3 masses.json a.dot").code == 0);
  CHECK(shell.folder.read("a.dot") == to_dot(Shell::diagram(), {.fold = 3}));
  CHECK(has(shell.folder.read("a.dot"), "▤"));
  CHECK(shell.titop("draw --compiled masses.json b.dot --fold 3").code == 0);
  CHECK(shell.folder.read("b.dot") == to_dot(compile(Shell::diagram()).stage(), {.fold = 3}));
}

TEST_CASE("draw makes pictures by Graphviz, text for it, and nothing else") {
  const Shell shell;
  CHECK(shell.titop("draw masses.json a.gv").code == 0);
  CHECK(shell.folder.read("a.gv") == to_dot(Shell::diagram()));
  CHECK(shell.titop("draw masses.json diagram").code == 0);
  CHECK(shell.folder.read("diagram") == to_dot(Shell::diagram()));
  const Run r = shell.titop("draw masses.json a.jpg");
  CHECK(r.code == 2);
  CHECK(has_name(r.err, "'a.jpg'"));
  CHECK(!std::filesystem::exists(shell.folder.path / "a.jpg"));
  const std::string without = "PATH=/nowhere '" TITOP_PROGRAM "' draw masses.json none.svg 2>err";
  CHECK(shell.folder.run(without) == 1);
  CHECK(has_line(shell.folder.read("err"), {"error[bad-file]", "none.svg", "dot"}));
  CHECK(has(shell.folder.read("err"), "dot -Tsvg FILE.dot -o FILE.svg"));
  CHECK(!std::filesystem::exists(shell.folder.path / "none.svg"));
  if (std::system("dot -V >/dev/null 2>&1") != 0) return;
  CHECK(shell.titop("draw masses.json a.svg").code == 0);
  CHECK(has(shell.folder.read("a.svg"), "</svg>"));
  CHECK(has(shell.folder.read("a.svg"), ">z3</text>"));
  CHECK(shell.titop("draw --compiled masses.json a.png").code == 0);
  CHECK(shell.folder.read("a.png").rfind("\x89PNG", 0) == 0);
  CHECK(shell.titop("draw masses.json a.pdf --fold 3").code == 0);
  CHECK(shell.folder.read("a.pdf").rfind("%PDF", 0) == 0);
}

TEST_CASE("report writes a page beside, or where it is told to") {
  const Shell shell;
  CHECK(shell.titop("report masses.json --no-diagrams").code == 0);
  CHECK(has(shell.folder.read("masses.html"), "<title>five masses</title>"));
  CHECK(has(shell.folder.read("masses.html"), "<section id=\"poles\">"));
  Run r = shell.titop("report masses.json -o 'my report.html' --no-diagrams --band 1 10 --until 4");
  CHECK(r.code == 0);
  CHECK(r.out.empty());
  CHECK(has(shell.folder.read("my report.html"), "</html>"));
  CHECK(shell.folder.run("mkdir there && mv masses.json there") == 0);
  CHECK(shell.titop("report there/masses.json --no-diagrams").code == 0);
  CHECK(has(shell.folder.read("there/masses.html"), "<title>five masses</title>"));
  CHECK(shell.folder.run("mv there/masses.json .") == 0);
  if (std::system("dot -V >/dev/null 2>&1") != 0) return;
  CHECK(shell.titop("report masses.json --fold 3").code == 0);
  CHECK(has(shell.folder.read("masses.html"), "▤"));
}

TEST_CASE("report without dot: exit code 1, and the way out") {
  const Shell shell;
  const std::string command = "PATH=/nowhere '" TITOP_PROGRAM "' report masses.json 2>err";
  CHECK(shell.folder.run(command) == 1);
  CHECK(has_line(shell.folder.read("err"), {"error[bad-file]", "dot"}));
  CHECK(has(shell.folder.read("err"), "--no-diagrams"));
}

TEST_CASE("export writes by the file's ending") {
  const Shell shell;
  const System system = compile(Shell::diagram());
  CHECK(shell.titop("export masses.json m.json").code == 0);
  CHECK(has(shell.folder.read("m.json"), "\"format\": \"titop model 1\""));
  CHECK(shell.titop("export masses.json m.m").code == 0);
  CHECK(has(shell.folder.read("m.m"), "function m = m ()"));
  CHECK(shell.titop("export masses.json m.py").code == 0);
  CHECK(has(shell.folder.read("m_A.npy"), "NUMPY"));
  CHECK(shell.titop("export masses.json masses.hpp --sample-time 0.01").code == 0);
  const CppModel cpp = generate_cpp(system, {.name = "masses", .sample_time = 0.01});
  CHECK(shell.folder.read("masses.hpp") == cpp.header);
  CHECK(shell.folder.read("masses_test.cpp") == cpp.test);
  CHECK(shell.titop("export masses.json g.csv --omega 1 100 3").code == 0);
  const std::vector<double> omega = {1, 10, 100};
  write_csv(system, omega, shell.folder.path / "expected.csv");
  CHECK(shell.folder.read("g.csv") == shell.folder.read("expected.csv"));
}

TEST_CASE("export of a frequency response: a block of three states without modal form, by hand") {
  const Shell shell;
  Diagram d{"filter"};
  const auto u = d.input("u");
  const Eigen::Matrix3d A{{-1, 0, 0}, {-1, 0, 0}, {0, -4, 0}};
  const auto K =
      d.add("K", Lti{.A = A, .B = Eigen::Vector3d(1, 0, 0), .C = Eigen::RowVector3d(0, 0, 1)});
  K.in = u;
  d.output("y") = K.out;
  write_diagram(d, shell.folder.path / "filter.json");
  CHECK(shell.titop("export filter.json g.csv --omega 0.5 2 3").code == 0);
  std::istringstream lines(shell.folder.read("g.csv"));
  std::string line;
  int rows = 0;
  while (std::getline(lines, line)) {
    double omega = 0, re = 0, im = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &omega, &re, &im) != 3) continue;
    ++rows;
    const std::complex<double> s(0, omega), exact = 4.0 / (s * s * (s + 1.0));
    CHECK(std::abs(std::complex<double>(re, im) - exact) <= 1e-14 * std::abs(exact));
  }
  CHECK(rows == 3);
}

TEST_CASE("export reports on stderr the digits lost by A, B, C, D, and how to keep them") {
  const Shell shell;
  Diagram d{"uneven"};  // every other mass 1e9 times as heavy as its neighbours
  const auto u = d.input("u");
  auto last = d.add("z0", SpringMass{.mass = 1, .stiffness = 100, .parent_mass = 0.5});
  ground(last);
  last.child.force += u;
  for (int i = 1; i < 10; ++i) {
    auto next =
        d.add("z" + std::to_string(i),
              SpringMass{.mass = i % 2 ? 1e9 : 1.0, .stiffness = 100.0 + i, .parent_mass = 0.5});
    mount(next, last.child);
    last = next;
  }
  d.output("a") = last.child.accel;
  write_diagram(d, shell.folder.path / "uneven.json");
  const System system = compile(d);
  const std::vector<std::string> warnings = dense_warnings(system);
  REQUIRE(!warnings.empty());
  for (const char* file : {"m.m", "m.py", "m_model.json", "m.hpp"}) {
    CAPTURE(file);
    const Run r = shell.titop(std::string("export uneven.json ") + file);
    for (const std::string& text : warnings) CHECK(has(r.err, "warning: " + text + "\n"));
    CHECK(has(r.err, "export DIAGRAM.json FILE.csv"));
    CHECK(has(r.err, "titop reduce DIAGRAM.json FILE --band"));
    CHECK(r.out.empty());
  }
  CHECK(has(shell.folder.read("m.m"), "% Warning: " + warnings[0]));
  CHECK(has(shell.folder.read("m.py"), "# Warning: " + warnings[0]));
  CHECK(has(shell.folder.read("m_model.json"), warnings[0]));
  CHECK(shell.titop("export uneven.json g.csv --omega 1.5 150 3").err == "");
  Diagram even{"even"};
  auto z = even.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  z.child.force += even.input("u");
  even.output("x") = z.stretch;
  write_diagram(even, shell.folder.path / "even.json");
  for (const char* file : {"m.m", "m.py", "m.json", "m.hpp"})
    CHECK(shell.titop(std::string("export even.json ") + file).err == "");
}

TEST_CASE("frequencies over any range, both ends exactly") {
  const Shell shell;
  CHECK(shell.titop("export masses.json g.csv --omega 1e-200 1e120 3").code == 0);
  std::istringstream lines(shell.folder.read("g.csv"));
  std::string line;
  std::vector<double> omega;  // the first column
  std::getline(lines, line);
  while (std::getline(lines, line)) omega.push_back(std::stod(line));
  REQUIRE(omega.size() == 3);
  CHECK(omega.front() == 1e-200);
  CHECK(std::abs(omega[1] / 1e-40 - 1) <= 1e-13);  // a root of 1e320, which is no double
  CHECK(omega.back() == 1e120);
}

TEST_CASE("text that cannot be printed is an error") {
  const Shell shell;
  if (!std::filesystem::exists("/dev/full")) return;
  for (const char* words : {"compile masses.json", "check masses.json", "--help"}) {
    INFO(words);
    const std::string command = std::string("'" TITOP_PROGRAM "' ") + words + " >/dev/full 2>err";
    CHECK(shell.folder.run(command) == 1);
    CHECK(has_name(shell.folder.read("err"), "error[bad-file]"));
    CHECK(!has(shell.folder.read("err"), "masses.json"));  // it is not the file's fault
  }
}

TEST_CASE("a scene that is refused: exit code 1 and the error on stderr") {
  const Shell shell;
  shell.folder.write("broken.json", "{\"format\": 1}");
  Run r = shell.titop("check broken.json");
  CHECK(r.code == 1);
  CHECK(r.out.empty());
  CHECK(has_line(r.err, {"error[bad-file]", "broken.json"}));
  CHECK(shell.titop("check none.json").code == 1);
  CHECK(shell.titop("export masses.json none/m.json").code == 1);
  Diagram open{"open"};
  open.add("z", SpringMass{});
  write_diagram(open, shell.folder.path / "open.json");
  r = shell.titop("compile open.json");
  CHECK(r.code == 1);
  CHECK(has_line(r.err, {"error[no-equation]", "z.parent"}));
}

TEST_CASE("draw --mode: the structure in the mode of a line of the table") {
  const Shell shell;
  Diagram d{"boom"};
  auto u = d.input("push");
  auto boom =
      d.add("boom", FlexibleBody{modal_data(Beam{.length = 1,
                                                 .section = rectangle(0.02, 0.01),
                                                 .material = {.E = 7e10, .nu = 0.3, .rho = 2700},
                                                 .elements = 2})});
  ground(boom);
  boom.child.force.along({0, 0, 1}) += u;
  d.output("tip") = boom.child.accel.along({0, 0, 1});
  write_diagram(d, shell.folder.path / "boom.json");
  CHECK(shell.titop("draw --mode 1 boom.json mode.svg").code == 0);
  CHECK(shell.folder.read("mode.svg") == plot_mode(compile(d), 0));
  CHECK(has(shell.titop("draw --mode 9 boom.json mode.svg").err, "--mode 9"));
  CHECK(shell.titop("draw --mode 1 boom.json mode.png").code == 2);
  CHECK(shell.titop("draw --mode 0 boom.json mode.svg").code == 2);
  CHECK(shell.titop("draw --mode 1 --compiled boom.json mode.svg").code == 2);
  CHECK(shell.titop("draw --mode 1 masses.json mode.svg").code == 1);  // no point in space
}
