// `titop generate`: the same numbers, the same files, which are those of the corpus; and invalid
// command lines.
#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "support/folder.hpp"

using titop_test::Folder;

namespace {

const std::string kFolder = TITOP_SOURCE_DIR "/tests/corpus/";

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Exit code.
int generate(const Folder& folder, const std::string& words) {
  if (folder.run("'" TITOP_PROGRAM "' generate " + words + "; echo $? >code") != 0) return -1;
  return std::stoi(folder.read("code"));
}

}  // namespace

TEST_CASE("every tenth scene of the corpus and its answer come out of their line of the list") {
  std::ifstream list(kFolder + "list.txt");
  const Folder folder;
  int lines = 0, compared = 0;
  for (std::string line; std::getline(list, line); ++lines) {
    if (lines % 10 != 3) continue;
    const std::string number = line.substr(0, 3);
    CAPTURE(line);
    CHECK(generate(folder, "a.json" + line.substr(3)) == 0);
    CHECK(folder.read("a.json") == content(kFolder + "scenes/" + number + ".json"));
    CHECK(folder.read("a.answer.json") == content(kFolder + "answers/" + number + ".json"));
    ++compared;
  }
  CHECK(lines == 224);
  CHECK(compared == 23);
}

TEST_CASE("invalid command lines: exit code 2; files that cannot be written: 1") {
  const Folder folder;
  for (const char* words :
       {"", "a.txt", "a.json b.json", "a.json --seed", "a.json --seed x", "a.json --seed -1",
        "a.json --family plane", "a.json --fast", "a.json --stiffness 3 3", "a.json --mistake none",
        "a.json --bodies 0"}) {
    CAPTURE(words);
    CHECK(generate(folder, words) == 2);
  }
  CHECK(generate(folder, "none/a.json") == 1);
}

TEST_CASE("a scene whose numbers outgrow their ratios is drawn anew") {
  const Folder folder;
  CHECK(generate(folder,
                 "a.json --seed 24 --family spatial --shape chain --bodies 100 --loops 1 "
                 "--no-controllers --mistake duplicate-name") == 0);
  CHECK(folder.read("a.answer.json").find("duplicate-name") != std::string::npos);
}

TEST_CASE("the written test: a file name with a quote, the order of more than 100 states") {
  const Folder folder;
  CHECK(generate(folder, "'q\"x.json'") == 0);
  const std::string test = folder.read("q\"x_test.cpp");
  CHECK(test.find("TEST_CASE(\"q\\\"x.json\")") != std::string::npos);
  CHECK(test.find("read_diagram(\"q\\\"x.json\")") != std::string::npos);
  CHECK(test.find("read_diagram(\"q\"x.json\")") == std::string::npos);
  CHECK(test.find(".minimize_up_to = 1000000") != std::string::npos);
}
