// docs/coming_from.md: its MATLAB text, run by Octave's control package, agrees with M and K by
// hand; its C++ text is that of the example.
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "support/folder.hpp"
#include "support/skip.hpp"

using titop_test::Folder;

namespace {

std::string content(const std::string& path) {
  std::ifstream file(TITOP_SOURCE_DIR "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The page's block of this language.
std::string block(const std::string& language) {
  const std::string page = content("docs/coming_from.md"), fence = "```" + language + "\n";
  const auto from = page.find(fence);
  REQUIRE(from != std::string::npos);
  return page.substr(from + fence.size(), page.find("```", from + 3) - from - fence.size());
}

}  // namespace

TEST_CASE("the page's C++ is the example's") {
  CHECK(content("examples/03_locked_mass.cpp").find(block("cpp")) != std::string::npos);
}

TEST_CASE("the page's MATLAB text in Octave: the transfer at 3 rad/s and the order") {
  if (std::system("octave-cli -q --eval 'pkg load control' >/dev/null 2>&1") != 0)
    return titop_test::skip("Octave with its control package is not installed");
  // (K - 9 M) x = [1; 0] for m0 = 2, m1 = 3 on springs of 50 and 80 N/m, m2 held:
  // x = [103, 50] / (32 * 103 - 50^2), outputs -9 x0, -9 x1, -80 x1.
  const Folder folder;
  folder.write("page.m", "pkg load control\n" + block("matlab") +
                             "x = [103; 50] / (32 * 103 - 2500);\n"
                             "exact = [-9 * x(1); -9 * x(2); -80 * x(2)];\n"
                             "G = freqresp (sys, 3);\n"
                             "assert (norm (G(:) - exact) <= 1e-12 * norm (exact));\n"
                             "assert (rows (ssdata (sys)) == 4);\n"
                             "printf ('well\\n');\n");
  const int code = folder.run("octave-cli -q page.m");
  INFO(folder.read("log.txt"));
  CHECK(code == 0);
  CHECK(folder.read("log.txt").find("well") != std::string::npos);
}
