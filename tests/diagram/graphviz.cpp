// Graphviz reads our output: every stage of every scene, and names of every kind.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scenes.hpp"

using namespace titop_test;
namespace fs = std::filesystem;

namespace {

/// A folder of its own, gone at the end.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "titop-dot-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()));
    path = name;
  }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

bool graphviz_is_missing() {
  if (std::system("dot -V > /dev/null 2>&1") == 0) return false;
  MESSAGE("SKIPPED: dot (Debian package graphviz) is not installed");
  return true;
}

std::string read(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Complaints of `dot` about a file: none, if it is well written.
std::string complaints(const fs::path& file) {
  const fs::path svg = fs::path(file).replace_extension("svg"), err = svg.string() + ".err";
  const std::string command =
      "dot -Tsvg '" + file.string() + "' -o '" + svg.string() + "' 2> '" + err.string() + "'";
  if (std::system(command.c_str()) != 0) return "dot failed: " + read(err);
  if (read(svg).find("</svg>") == std::string::npos) return "no picture";
  std::istringstream lines(read(err));
  std::string line, found;
  while (std::getline(lines, line))  // fonts are the machine's business
    if (line.find("ontconfig") == std::string::npos && line.find("font") == std::string::npos)
      found += line + "\n";
  return found;
}

}  // namespace

TEST_CASE("Graphviz reads every stage of every scene") {
  if (graphviz_is_missing()) return;
  for (const auto& scene : {five_masses, fig12, spacecraft, robot_joint, controlled, pinned}) {
    const Folder folder;
    const Diagram d = scene();
    compile(d, {.dump_to = folder.path.string()});
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder.path)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    REQUIRE(files.size() == 8);
    CHECK(files.front().filename() == "00-diagram.dot");
    CHECK(read(files.front()) == to_dot(d));
    for (const fs::path& file : files) {
      INFO(d.name(), ", ", file.filename().string());
      CHECK(complaints(file) == "");
      CHECK(read(file).find("0x") == std::string::npos);
    }
  }
}

TEST_CASE("Graphviz reads diagrams that need no legend") {
  if (graphviz_is_missing()) return;
  const Folder folder;
  Diagram empty{"empty"}, gain{"gain"};
  auto K = gain.add("K", Gain{.gain = 3});
  K.in = gain.input("u");
  gain.output("y") = K.out;
  for (const Diagram* d : {&empty, &gain}) {
    const fs::path file = folder.path / "plain.dot";
    std::ofstream(file) << to_dot(*d);
    INFO(d->name());
    CHECK(complaints(file) == "");
    CHECK(read(file).find("<B>" + d->name() + "</B>") != std::string::npos);
  }
}

TEST_CASE("Graphviz reads names of every kind") {
  if (graphviz_is_missing()) return;
  const Folder folder;
  for (const std::string name :
       {"",      " ",     "a b",         "\"quoted\"",  "back\\slash", "ends with \\",
        "\\",    "\\n",   "<b>bold</b>", "&amp; &lt;",  "]]>",         "-->",
        "a:b:n", "{x|y}", "κ̈ 机翼 🛰",    "line\nbreak", "tab\t\x01",   "broken \xC3( utf-8 \xFF",
        "node",  "graph", "12",          "%s {} $(x)"}) {
    Diagram d{name};
    auto u = d.input(name);
    auto k = d.param(name, 2.0);
    auto z = d.add(name, SpringMass{});
    auto b = d.add(name + "2", box({{name.empty() ? "C" : name, {1, 0, 0}}}));
    auto c = d.add(name, SpringMass{});  // a name used twice is a mistake, yet it can be drawn
    z.child.force = -(k * u);
    c.parent.accel = z.child.accel;
    b.parent.accel = 0;
    d.output(name) = z.stretch + c.stretch;
    const fs::path file = folder.path / "name.dot";
    std::ofstream(file) << to_dot(d);
    INFO(name);
    CHECK(complaints(file) == "");
  }
}
