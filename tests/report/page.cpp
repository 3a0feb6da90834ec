// The report as a whole: its structure, its numbers, text of any origin, and missing parts.
#include <doctest/doctest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <numbers>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/close.hpp"
#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/mistakes.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;

namespace {

const ReportOptions kNoDiagrams{.diagrams = false};

System five_masses() { return compile(five_masses_scene(kMasses, kStiffnesses)); }

bool dot_is_missing() { return std::system("dot -V >/dev/null 2>&1") != 0; }

/// Cells of a table's body, row by row, as text.
std::vector<std::vector<std::string>> cells(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& row : between(table, "<tr>", "</tr>")) {
    std::vector<std::string> list;
    for (const std::string& cell : between(row, "<td", "</td>"))
      list.push_back(cell.substr(cell.find('>') + 1));
    if (!list.empty()) rows.push_back(list);
  }
  return rows;
}

/// A folder that is all of the PATH, as long as this lives.
struct Path {
  Folder folder;
  std::string before = getenv("PATH");
  Path() { setenv("PATH", folder.path.c_str(), 1); }
  ~Path() { setenv("PATH", before.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;
  void program(const std::string& name, const std::string& text) const {
    folder.write(name, text);
    chmod((folder.path / name).c_str(), 0755);
  }
};

/// Checks that a browser fetches and runs nothing.
void check_self_contained(const std::string& page) {
  for (const char* part : {"<script", "<link", "<img", "<iframe", "<object",
                           "src=", "http:", "https:", "url(", "@import", "onload", "xlink"}) {
    INFO(part);
    CHECK_FALSE(has(page, part));
  }
}

}  // namespace

TEST_CASE("the page is well formed, has every section, and needs nothing from elsewhere") {
  if (dot_is_missing()) return titop_test::skip("dot (Graphviz) is not installed");
  const std::string page = report_html(five_masses());
  CHECK(complaint(page) == "");
  check_self_contained(page);
  for (const char* id :
       {"scene", "poles", "frequency", "time", "certificate", "order", "passes", "states"}) {
    section(page, id);
    CHECK(count(page, "href=\"#" + std::string(id) + "\"") == 1);
  }
  CHECK(count(section(page, "scene"), "<svg class=\"drawing\"") == 2);
  CHECK(has(section(page, "scene"), ">z3</text>"));
  CHECK(has(page, "<title>five masses</title>"));
}

TEST_CASE("every plot has axes with units, a legend, and as many lines as names") {
  const std::string page = report_html(five_masses(), kNoDiagrams);
  const auto plots = between(page, "<figure class=\"plot\">", "</figure>");
  // Five positions and an acceleration from one force: two units, four curves in a figure at most.
  // Singular values: 5 x 1 (the single acceleration has its Bode plot). Steps as Bode plots.
  REQUIRE(plots.size() == 1 + 3 + 3);
  for (const std::string& plot : plots) {
    const std::size_t frames = count(plot, "class=\"frame\"");
    CHECK(count(plot, "class=\"x-label\"") == 1);
    CHECK(count(plot, "class=\"y-label\"") == frames);
    const bool over_time = has(plot, ">time [s]</text>");
    CHECK((over_time || has(plot, ">frequency [Hz]</text>")));
    const std::size_t names = count(plot, "<li>");
    CHECK(names >= 1);
    CHECK(names <= 4);
    CHECK(count(plot, "class=\"curve") == names * (1 + frames));
    CHECK(count(plot, " d=\"\"") == 0);
  }
  const std::string bode = section(page, "frequency");
  CHECK(count(bode, ">magnitude [m / N]</text>") == 2);
  CHECK(count(bode, ">magnitude [m/s² / N]</text>") == 1);
  CHECK(count(bode, ">phase [deg]</text>") == 3);
  CHECK(count(section(page, "time"), ">response [m/s²]</text>") == 1);
}

TEST_CASE("poles are the eigenvalues of M and K, with shares of the blocks that add up") {
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  const Matrix5 K = impedance(kMasses, kStiffnesses, 0).real();
  const Matrix5 M = Eigen::Map<const Eigen::Matrix<double, 5, 1>>(kMasses.data()).asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix5> modes(K, M);
  const auto rows = cells(section(report_html(five_masses(), kNoDiagrams), "poles"));
  REQUIRE(rows.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    const double omega = std::sqrt(modes.eigenvalues()(static_cast<Eigen::Index>(k)));
    CHECK(relative(std::stod(rows[k][1]), omega / (2 * std::numbers::pi)) <= 5e-6);
    CHECK(relative(std::stod(rows[k][2]), omega) <= 5e-6);
    CHECK(rows[k][3] == "0");
    double share = 0;
    for (const std::string& s : between(rows[k][5], "</i>", " %"))
      share += std::stod(s.substr(s.rfind(' ')));
    CHECK(share >= 80);  // each part below 5 % is left out
    CHECK(share <= 102);
  }
}

TEST_CASE("poles beyond the band are folded, and of many without a band all but the slowest") {
  // 50 masses in a row on a wall: omega_k = 2 sin((2 k - 1) pi / 202), k = 1 ... 50.
  Diagram d{"row"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (int i = 1; i <= 50; ++i) z.push_back(d.add(fmt::format("z{}", i), SpringMass{}));
  ground(z.front());
  for (std::size_t i = 1; i < z.size(); ++i) mount(z[i], z[i - 1].child);
  z.back().child.force += u;
  d.output("x") = z.front().stretch;
  const System system = compile(d);
  const auto listed = [&](const ReportOptions& options) {
    const std::string text = section(report_html(system, options), "poles");
    CHECK(between(text, "<details>", "</details>").size() == 1);
    CHECK(cells(text).size() == 50);
    return cells(text.substr(0, text.find("<details>"))).size();
  };
  CHECK(listed(kNoDiagrams) == 24);
  const double hertz = 2 * std::sin(17 * std::numbers::pi / 202) / (2 * std::numbers::pi);  // k = 9
  CHECK(listed({.diagrams = false, .band_hz = {0.001, 1.01 * hertz}}) == 9);
  CHECK(
      between(section(report_html(five_masses(), kNoDiagrams), "poles"), "<details>", "<").empty());
}

TEST_CASE("removed states, with the reason: twin masses swing against each other unseen") {
  Five k = kStiffnesses;
  k[4] = k[3] / kMasses[3] * kMasses[4];
  const System system = compile(third_of_five(kMasses, k));
  CHECK(system.order_verdict().decided());
  const std::string order = section(report_html(system, kNoDiagrams), "order");
  CHECK(has_name(order, "Order 8"));
  const auto rows = cells(between(order, "class=\"modes\">", "</table>").at(0));
  REQUIRE(rows.size() == 1);
  CHECK(relative(std::stod(rows[0][0]), std::sqrt(k[3] / kMasses[3])) <= 5e-6);
  CHECK(rows[0][1] == "2");
  CHECK(rows[0][4] != "");
}

TEST_CASE("the certificate states whether forces are reciprocal, or why that is not checked") {
  const auto certificate = [](bool pushed_by_filter) {
    Diagram d{"two"};
    auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
    auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 18});
    ground(a);
    mount(b, a.child);
    if (pushed_by_filter) {
      auto filter = d.add("filter", Gain{.gain = 3});
      filter.in = a.stretch;
      b.child.force += filter.out;
    }
    a.child.force += d.input("f");
    b.child.force += d.input("g");
    d.output("a") = a.child.accel;
    d.output("b") = b.child.accel;
    return section(report_html(compile(d), kNoDiagrams), "certificate");
  };
  int rows = 0;
  for (const bool pushed : {false, true})
    for (const auto& row : cells(certificate(pushed)))
      if (has(row[0], "reciprocity")) {
        ++rows;
        CHECK(has(row[2], "class=\"good\"") == !pushed);
        CHECK(has_name(row[3], "2 forces"));
        CHECK(has_names(row[3], {"b.child.force", "filter.out"}) == pushed);
      }
  CHECK(rows == 2);
}

TEST_CASE("the summary begins with the findings: unstable, unchecked, undecided") {
  const Verdict undamped = verdicts(report_html(five_masses(), kNoDiagrams)).at(0);
  CHECK(undamped.cls == "good");
  CHECK(has_name(undamped.html, "10"));
  Diagram d{"rolls away"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  z.child.force = u + 1.0 * z.child.rate;  // damping -1
  d.output("x") = z.position;
  const std::string page = report_html(compile(d), kNoDiagrams);
  const Verdict unstable = verdicts(page).at(0);
  CHECK(unstable.cls == "bad");
  CHECK(has_name(unstable.html, "2"));
  const auto rows = cells(section(page, "poles"));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0][3] == "-25");  // s = 1/2 +- j sqrt(4 - 1/4)
  CHECK(rows[0][4] == "0.5");
  const System large = compile(five_masses_scene(kMasses, kStiffnesses), {.minimize_up_to = 0});
  CHECK(!large.order_verdict().judged);
  const Verdict unjudged = verdicts(report_html(large, kNoDiagrams)).at(2);  // all checks hold
  CHECK(unjudged.cls == "open");
  CHECK(has_name(unjudged.html, "Order 10"));
}

TEST_CASE("scenes without inputs, outputs or states have a report") {
  Diagram modes{"modes"};
  auto z = modes.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  std::string page = report_html(compile(modes), kNoDiagrams);
  CHECK(complaint(page) == "");
  CHECK(section(page, "frequency") != "");
  CHECK(count(section(page, "frequency"), "<figure") == 0);
  Diagram rigid{"rigid"};
  auto W = rigid.input("W", 6);
  auto B = rigid.add("B", RigidBody{.mass = 10});
  B.parent.force = -W;
  rigid.output("a", 6) = B.parent.accel;
  page = report_html(compile(rigid), kNoDiagrams);
  CHECK(complaint(page) == "");
  CHECK(section(page, "poles") != "");
  CHECK(cells(section(page, "poles")).empty());
  // Force to acceleration and moment to rotation; the other pairs are 0.
  CHECK(count(section(page, "time"), "<figure") == 2);
  CHECK(count(section(page, "frequency"), "<figure") == 2 + 2);  // singular values, Bode
  CHECK(count(section(page, "frequency"), " d=\"\"") == 0);
  Diagram deaf{"deaf"};
  auto v = deaf.input("v");
  auto a = deaf.add("a", SpringMass{}), b = deaf.add("b", SpringMass{});
  ground(a), ground(b);
  a.child.force = v;
  deaf.output("x") = b.position;
  page = report_html(compile(deaf), kNoDiagrams);
  CHECK(complaint(page) == "");
  CHECK(section(page, "time") != "");
  CHECK(count(section(page, "time"), "<figure") == 0);
}

TEST_CASE("a start far outside of the rest is cut, and the caption has its range") {
  Diagram d{"damped"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 1, .damping = 100});
  ground(z);
  z.child.force = u;
  d.output("a") = z.child.accel;  // 1 at first, less than 1e-4 after a tenth of a second
  d.output("x") = z.position;     // slow: no such start
  const std::string page = report_html(compile(d), {.diagrams = false, .until = 600});
  const auto captions = between(section(page, "time"), "<figcaption>", "</figcaption>");
  REQUIRE(captions.size() == 1);
  CHECK(has_name(captions.front(), "1 m/s²"));
}

TEST_CASE("names of any kind are text, nowhere markup") {
  const bool draw = !dot_is_missing();
  for (const std::string name :
       {"</title><script>alert(1)</script>", "\"><img src=\"x\" onerror=\"alert(1)\"/>",
        "&lt;b&gt; & ]]> -->", "<!-- ", "'; DROP", "$(touch pwned) `x` \\", "κ̈ 机翼 🛰",
        "line\nbreak\ttab\x01", "broken \xC3( \xFF", "%s {} {0}", "a id=\"x\" b", " "}) {
    Diagram d{name};
    auto u = d.input(name);
    auto z = d.add(name, SpringMass{.mass = 1, .stiffness = 4, .damping = 0.1});
    ground(z);
    z.child.force = u;
    d.output(name) = z.stretch;
    INFO(name);
    const std::string page = report_html(
        compile(d), {.title = name, .remark = name, .diagrams = draw, .units = {{name, name}}});
    CHECK(complaint(page) == "");
    for (const char* part : {"<script", "<img", "<!--"}) CHECK_FALSE(has(page, part));
  }
}

TEST_CASE("without dot, or with one that fails, there is an error with the way out") {
  const System system = five_masses();
  const Path path;
  Error error = error_of([&] { report_html(system); });
  CHECK(says(error, Code::bad_file, {"dot", "graphviz", "--no-diagrams"}));
  CHECK(complaint(report_html(system, kNoDiagrams)) == "");
  path.program("dot", "#!/bin/sh\necho 'bad fonts' >&2\nexit 3\n");
  error = error_of([&] { report_html(system); });
  CHECK(says(error, Code::bad_file, {"dot", "3", "bad fonts", "--no-diagrams"}));
  CHECK_FALSE(has_name(error.what(), "graphviz"));  // the package: it is there
  path.program("dot", "#!/bin/sh\necho '<html/>'\n");
  CHECK(says(error_of([&] { report_html(system); }), Code::bad_file, {"dot", "0"}));
  path.program("dot", "no program at all");
  CHECK(error_of([&] { report_html(system); }).has(Code::bad_file));
}

TEST_CASE("options are looked at: pairs, units, band, end, title") {
  const System system = five_masses();
  ReportOptions options = kNoDiagrams;
  options.title = "For the review", options.remark = "first line\nsecond line";
  options.pairs = {{"x5", "u"}};
  options.units = {{"u", "kN"}, {"x5", "mm"}};
  options.band_hz = {1, 10};
  options.until = 4;
  const std::string page = report_html(system, options);
  CHECK(has(page, "<h1>For the review</h1>"));
  CHECK(has(page, "first line<br/>second line"));
  CHECK(count(section(page, "time"), "<figure") == 1);
  CHECK(has(section(page, "time"), " mm]</text>"));
  CHECK(has(section(page, "frequency"), ">magnitude [mm / kN]</text>"));
  const auto refused = [&](auto change, Code code, std::initializer_list<std::string_view> words) {
    ReportOptions wrong = kNoDiagrams;
    change(wrong);
    return says(error_of([&] { report_html(system, wrong); }), code, words);
  };
  CHECK(refused([](auto& o) { o.pairs = {{"x9", "u"}}; }, Code::unknown_name, {"x9", "x1, x2"}));
  CHECK(refused([](auto& o) { o.pairs = {{"x1", "v"}}; }, Code::unknown_name, {"\"v\"", "u"}));
  CHECK(refused([](auto& o) { o.units = {{"w", "N"}}; }, Code::unknown_name, {"\"w\"", "a3"}));
  CHECK(refused([](auto& o) { o.band_hz = {3, 1}; }, Code::bad_value, {"3", "1 Hz"}));
  CHECK(refused([](auto& o) { o.until = -1; }, Code::bad_value, {"-1 s"}));
}

TEST_CASE("the text is the same on every run but for the times") {
  const auto text = [] {
    const std::string page = report_html(five_masses(), kNoDiagrams);
    return page.substr(0, page.find("<section id=\"passes\">"));
  };
  CHECK(text() == text());
}

TEST_CASE("all passes stand in the table, with times that add up") {
  const auto rows = cells(section(report_html(five_masses(), kNoDiagrams), "passes"));
  std::vector<std::string> names;
  for (const auto& row : rows)
    if (!row[0].empty()) names.push_back(row[0]);
  const std::vector<std::string> all = {"check", "lower",  "split",   "chains", "match",
                                        "order", "close",  "layout",  "blocks", "join",
                                        "solve", "pivots", "certify", "dense",  "minimize"};
  CHECK(names == all);
  for (const auto& row : rows) CHECK(row[3] != "");
}

TEST_CASE("write_report writes the page, or throws with the path") {
  const Folder folder;
  const System system = five_masses();
  write_report(system, folder.path / "a report's name.html", kNoDiagrams);
  CHECK(complaint(folder.read("a report's name.html")) == "");
  const Error error =
      error_of([&] { write_report(system, folder.path / "none" / "r.html", kNoDiagrams); });
  CHECK(says(error, Code::bad_file, {"none/r.html"}));
}

TEST_CASE("numbers inside a sentence are text, too") {
  const std::string certificate = section(report_html(five_masses(), kNoDiagrams), "certificate");
  CHECK(has(certificate, "·10⁻¹"));
  CHECK_FALSE(has(certificate, "&lt;"));
}

TEST_CASE("scenes of controllers alone are drawn") {
  if (dot_is_missing()) return titop_test::skip("dot (Graphviz) is not installed");
  Diagram d{"gain"};
  auto K = d.add("K", Gain{.gain = 3});
  K.in = d.input("u");
  d.output("y") = K.out;
  const std::string page = report_html(compile(d));
  CHECK(complaint(page) == "");
  CHECK(count(section(page, "scene"), "<svg") == 2);
}

TEST_CASE("a response that settles to the last digit is drawn") {
  Diagram d{"hardly"};
  auto K = d.add("K", Lti{.A = -Eigen::MatrixXd::Ones(1, 1),
                          .B = Eigen::MatrixXd::Ones(1, 1),
                          .C = Eigen::MatrixXd::Constant(1, 1, 3e-16),
                          .D = Eigen::MatrixXd::Ones(1, 1)});
  K.in = d.input("u");
  d.output("y") = K.out;
  CHECK(report_html(compile(d), {.diagrams = false}).find("</html>") != std::string::npos);
}
