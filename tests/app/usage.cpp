// The command line: help, its manual page, and words that it refuses.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <titop/titop.hpp>

#include "app/masses_shell.hpp"
#include "support/names.hpp"

using namespace titop;
using namespace titop_test;
using app_test::has;
using app_test::Run;
using Shell = app_test::MassesShell;

TEST_CASE("--help prints the usage on stdout") {
  const Shell shell;
  for (const char* words : {"--help", "-h", "help", "certify --help", "generate --help"}) {
    INFO(words);
    const Run r = shell.titop(words);
    CHECK(r.code == 0);
    CHECK(has(r.out, "usage:"));
    CHECK(has(r.out, "titop generate DIAGRAM.json"));
    CHECK(r.err.empty());
  }
}

TEST_CASE("invalid command lines: exit code 2, and one line on stderr with the reason") {
  const Shell shell;
  const std::string scene = shell.folder.read("masses.json");
  shell.folder.write("masses.html", scene);  // a scene whose report would overwrite it
  for (const char* words : {"",
                            "fly masses.json",
                            "check",
                            "check masses.json more",
                            "check --fast masses.json",
                            "export masses.json m.txt",
                            "export masses.json g.csv",
                            "export masses.json g.csv --omega 1 x 3",
                            "export masses.json g.csv --omega 3 1 3",
                            "export masses.json m.hpp --sample-time",
                            "report",
                            "report masses.json -o",
                            "report masses.json --band 1",
                            "report masses.json --band 1 2 --band 1 2",
                            "draw --fold -1 masses.json a.dot",
                            "certify",
                            "certify masses.json c.json",
                            "export masses.json m.m --sample-time 0.01",
                            "export masses.json m.hpp --omega 1 10 3",
                            "compile masses.json -o log.txt",
                            "check masses.json --omega 1 10 3",
                            "draw masses.json a.dot --band 1 2",
                            "check masses.json --minimize-up-to 1e10",
                            "export masses.json masses.json",
                            "draw masses.json ./masses.json",
                            "certify masses.json -o masses.json",
                            "report masses.json -o masses.json",
                            "report masses.json --band 0 0",
                            "report masses.json --band 10 1",
                            "report masses.json --until 0",
                            "export masses.json m.hpp --sample-time 0",
                            "draw --fold 2.7 masses.json a.dot",
                            "draw masses.json a.txt",
                            "check masses.json --minimize-up-to 1.5",
                            "export masses.json g.csv --omega 1 10 2.9",
                            "export masses.json g.csv --omega 1 10 0",
                            "export masses.json g.csv --omega 1 10 1e300",
                            "export masses.json g.csv --omega 0 10 3",
                            "export masses.json g.csv --omega 1 10 3 --omega 1 10 3",
                            "report masses.html --no-diagrams"}) {
    INFO(words);
    const Run r = shell.titop(words);
    CHECK(r.code == 2);
    CHECK(r.err.rfind("titop: ", 0) == 0);
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 2);
    CHECK(has(r.err, "\ntitop --help "));
    CHECK(r.out.empty());
  }
  CHECK(shell.folder.read("masses.html") == scene);
  CHECK(has_line(shell.titop("report masses.json --band 1").err, {"titop", "--band"}));
  CHECK(has_line(shell.titop("export masses.json g.csv --omega 1 x 3").err, {"--omega", "'x'"}));
  CHECK(has_line(shell.titop("export masses.json m.py --sample-time 0.01").err,
                 {"export", ".py", "--sample-time"}));
  CHECK(shell.titop("check masses.json").code == 0);  // no scene is written over
}

TEST_CASE("the manual page names every command of --help, and no other") {
  const Shell shell;
  std::ifstream file(TITOP_SOURCE_DIR "/docs/titop.1");
  std::set<std::string> documented, existing;
  for (std::string line, before; std::getline(file, line); before = line)
    if (before == ".TP" && line.starts_with(".B ") && !line.starts_with(".B -"))
      documented.insert(line.substr(3));
  std::istringstream help(shell.titop("--help").out);
  for (std::string line; std::getline(help, line);)
    if (std::istringstream words(line); line.starts_with("  titop ")) {
      std::string titop, command;
      words >> titop >> command;
      if (!command.starts_with("-")) existing.insert(command);
    }
  CHECK(existing.size() >= 12);
  CHECK(documented == existing);
}

TEST_CASE("the manual page names every option of --help, and no other") {
  const Shell shell;
  std::ifstream file(TITOP_SOURCE_DIR "/docs/titop.1");
  std::set<std::string> documented, existing;
  for (std::string line, before; std::getline(file, line); before = line)
    if (before == ".TP" && (line.starts_with(".BI -") || line.starts_with(".B -")))
      documented.insert(
          line.substr(line.find('-'), line.find(' ', line.find('-')) - line.find('-')));
  std::istringstream help(shell.titop("--help").out);
  for (std::string line; std::getline(help, line);)
    if (line.starts_with("  -")) existing.insert(line.substr(2, line.find(' ', 2) - 2));
  CHECK(existing.size() >= 25);
  CHECK(documented == existing);
}
