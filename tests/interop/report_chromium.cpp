// A browser and a parser read the report: no word on the console, a picture, a print-out.
#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;

namespace {

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// Two springs whose names are longer than a column, a law and numbers of many digits.
Diagram long_names() {
  Diagram d{"long names"};
  auto u = d.input("the force that the actuator exerts");
  auto a =
      d.add("the inner spring of the northern wing", SpringMass{.mass = 1, .stiffness = 12345});
  auto b =
      d.add("the outer spring of the northern wing", SpringMass{.mass = 2, .stiffness = 0.125});
  a.parent.accel = 0;
  b.parent.accel = a.child.accel;
  a.child.force = b.parent.force - u;
  d.output("the stretch of the outer spring") = b.stretch;
  return d;
}

}  // namespace

TEST_CASE("the report is as wide as its window, and as a page of A4 between its margins") {
  if (!runs("command -v chromium")) return titop_test::skip("Chromium is not installed");
  const std::string page = report_html(compile(long_names()));
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  const std::string measured =
      with(page, "</body>",
           "<script>onload = () => { const e = document.documentElement;"
           " parent.postMessage(e.scrollWidth - e.clientWidth, '*') }</script></body>");
  const std::string paper = with(measured, "@media print", "@media all");
  for (const auto& [text, width] :
       {std::pair(measured, 1280), std::pair(measured, 400), std::pair(paper, 688)}) {  // 182 mm
    CAPTURE(width);
    const Folder folder;
    folder.write("report.html", text);
    // In a frame: Chromium's windows are never narrower than 500 pixels.
    folder.write("frame.html",
                 "<html><body><iframe src='report.html' style='border:0;height:2000px;width:" +
                     std::to_string(width) +
                     "px'></iframe><script>onmessage = e => document.title = 'beyond ' + e.data"
                     "</script></body></html>");
    CHECK(folder.run("chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
                     "--hide-scrollbars --user-data-dir=profile --virtual-time-budget=2000 "
                     "--window-size=1400,2100 --dump-dom frame.html") == 0);
    CHECK(folder.read("log.txt").find("<title>beyond 0</title>") != std::string::npos);
  }
}

TEST_CASE("Chromium shows the report without an error, and prints it") {
  if (!runs("command -v chromium")) return titop_test::skip("Chromium is not installed");
  const Folder folder;
  write_report(compile(five_masses_scene(kMasses, kStiffnesses)), folder.path / "report.html");
  const std::string chromium =
      "chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars "
      "--user-data-dir=profile --enable-logging=stderr ";
  CHECK(folder.run(chromium + "--window-size=1280,4000 --screenshot=report.png report.html",
                   "screen.txt") == 0);
  const std::string words = folder.read("screen.txt"), png = folder.read("report.png");
  INFO(words);
  CHECK(words.find("CONSOLE") == std::string::npos);
  CHECK(png.substr(1, 3) == "PNG");
  CHECK(png.size() > 100'000);  // a blank page of this size has 23,000
  CHECK(folder.run(chromium + "--no-pdf-header-footer --print-to-pdf=report.pdf report.html",
                   "paper.txt") == 0);
  CHECK(folder.read("report.pdf").substr(0, 5) == "%PDF-");
}

TEST_CASE("Python's XML parser reads the report") {
  if (!runs("python3 --version")) return titop_test::skip("Python is not installed");
  const Folder folder;
  write_report(compile(five_masses_scene(kMasses, kStiffnesses)), folder.path / "report.html");
  folder.write("check.py", R"py(
import xml.etree.ElementTree as tree
page = tree.parse("report.html").getroot()
assert page.tag == "html"
assert len(page.findall(".//section")) == 8
assert len(page.findall(".//figure[@class='diagram']//svg")) == 2
assert len(page.findall(".//figure[@class='plot']")) == 7
)py");
  const int failed = folder.run("python3 check.py");
  INFO(folder.read("log.txt"));
  CHECK(failed == 0);
}
