// Code and output in docs/guide are parts of examples that run, line by line.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

const fs::path kRoot = TITOP_SOURCE_DIR;

std::string trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : line.substr(first, line.find_last_not_of(' ') + 1 - first);
}

Lines read(const fs::path& path) {
  std::ifstream file(path);
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// A fenced block and the example that was last linked to before it.
struct Quote {
  std::string source;
  Lines lines;
};

std::vector<Quote> quotes(const Lines& page) {
  std::vector<Quote> list;
  std::string source;
  bool inside = false;
  for (const std::string& line : page) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) list.push_back({source, {}});
    } else if (inside) {
      list.back().lines.push_back(trimmed(line));
    } else if (const auto at = line.find("](../../examples/"); at != std::string::npos) {
      const auto from = at + 8;
      source = line.substr(from, line.find(')', from) - from);
    }
  }
  return list;
}

/// The first line of the quote that does not follow where it should; "" if it is all there. "..."
/// leaves lines out.
std::string first_missing(const Lines& quote, Lines source) {
  std::transform(source.begin(), source.end(), source.begin(), trimmed);
  auto at = source.begin();
  bool anywhere = true;
  for (const std::string& line : quote) {
    if (line == "...") {
      anywhere = true;
      continue;
    }
    const auto found = anywhere ? std::find(at, source.end(), line) : at;
    if (found == source.end() || *found != line) return line;
    at = found + 1;
    anywhere = false;
  }
  return {};
}

/// Files that a page links to; anchors and the web left out, and code such as `[](double x)`.
Lines link_targets(const Lines& page) {
  Lines targets;
  for (const std::string& line : page)
    for (auto at = line.find("]("); at != std::string::npos; at = line.find("](", at + 1)) {
      std::string target = line.substr(at + 2, line.find(')', at) - at - 2);
      target = target.substr(0, target.find('#'));
      if (!target.empty() && target.find("://") == std::string::npos &&
          target.find(' ') == std::string::npos)
        targets.push_back(target);
    }
  return targets;
}

}  // namespace

TEST_CASE("quotations of the guide are lines of the example that it links") {
  int quoted = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "docs/guide")) {
    CAPTURE(entry.path().filename().string());
    for (const Quote& q : quotes(read(entry.path()))) {
      CAPTURE(q.source);
      REQUIRE(fs::is_regular_file(kRoot / q.source));
      CHECK(first_missing(q.lines, read(kRoot / q.source)) == "");
      ++quoted;
    }
  }
  CHECK(quoted >= 15);
}

TEST_CASE("links of the pages lead to files of the project") {
  int links = 0;
  for (const char* folder : {"docs", "docs/guide"})
    for (const auto& entry : fs::directory_iterator(kRoot / folder)) {
      if (entry.path().extension() != ".md") continue;
      for (const std::string& target : link_targets(read(entry.path()))) {
        CAPTURE(entry.path().filename().string() + ": " + target);
        CHECK(fs::exists(entry.path().parent_path() / target));
        ++links;
      }
    }
  CHECK(links >= 20);
}
