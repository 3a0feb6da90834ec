// The checks that a generated test makes pass for every correct model: small outputs far along
// a chain, terms that cancel, static gains that are 0 by nature, other ways of rounding.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using titop_test::Folder;

namespace {

/// "" if the model's own test compiles and passes as rounded by these compiler's options, else its
/// output.
std::string proves(const System& system, double sample_time, const std::string& options) {
  const Folder folder;
  write(generate_cpp(system, {.name = "model", .sample_time = sample_time}), folder.path);
  if (folder.run("g++ -std=c++17 " + options + " model_test.cpp -o proof") != 0)
    return "does not compile: " + folder.read("log.txt");
  return folder.run("./proof") == 0 ? "" : folder.read("log.txt");
}

bool compiler_found() {
  const bool found = std::system("command -v g++ >/dev/null 2>&1") == 0;
  if (!found) titop_test::skip("g++ is not installed");
  return found;
}

/// Masses in a row, pushed at the far end and watched at the near one, which is free.
System chain(int masses) {
  Diagram d{"chain"};
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < masses; ++i)
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      SpringMass{.mass = 1, .stiffness = 10, .parent_mass = i == 0 ? 1.0 : 0.0}));
  z[0].parent.force = 0;
  for (std::size_t i = 1; i < z.size(); ++i) mount(z[i], z[i - 1].child);
  z.back().child.force += d.input("u");
  d.output("x") = z[0].stretch;
  return compile(d);
}

/// 1 / ((s + 1e5) (s - 1e5) + 1e10 + 1e5): five digits cancel in the solution with s - A.
System cancelling() {
  Diagram d{"cancelling"};
  auto K = d.add("K", Lti{.A = Eigen::Matrix2d{{1e5, -1e5 - 1}, {1e5, -1e5}},
                          .B = Eigen::Vector2d(1, 0),
                          .C = Eigen::RowVector2d(1, 0)});
  K.in = d.input("u");
  d.output("y") = K.out;
  return compile(d);
}

}  // namespace

TEST_CASE("an output of order h^24 in the first steps, and terms that cancel") {
  if (!compiler_found()) return;
  CHECK(proves(chain(12), 0.01, "-O0") == "");
  CHECK(proves(cancelling(), 0.1, "-O0") == "");
  CHECK(proves(cancelling(), 0.1, "-O2 -ffast-math -fno-finite-math-only") == "");
}

TEST_CASE("static gains of scenes in which almost all is 0 at rest") {
  if (!compiler_found()) return;
  for (const char* number : {"028", "061", "083"}) {
    CAPTURE(number);
    const System system =
        compile(read_diagram(fmt::format(TITOP_SOURCE_DIR "/tests/corpus/scenes/{}.json", number)));
    CHECK(proves(system, 0.1, "-O0") == "");
    CHECK(generate_cpp(system, {.name = "a"}).test.find(": static gain\")") != std::string::npos);
  }
}
