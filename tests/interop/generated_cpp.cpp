// Generated C++ is compiled by g++ and clang with warnings as errors, its own test runs, and fails
// if a single number of the header is wrong.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop::generate;
using namespace titop_test;

namespace {

const char* const kFlags =
    " -std=c++17 -O0 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror "
    "-DTITOP_TEST_WITHOUT_MAIN ";

std::vector<std::string> compilers() {
  std::vector<std::string> found;
  for (const char* name : {"g++", "clang++-16"})
    if (std::system(("command -v " + std::string(name) + " >/dev/null 2>&1").c_str()) == 0)
      found.emplace_back(name);
    else
      titop_test::skip(std::string(name) + " is not installed");
  return found;
}

/// A folder with doctest's main, compiled once for all models.
struct Workshop {
  Folder folder;
  std::string compiler;

  explicit Workshop(const std::string& name) : compiler(name) {
    folder.write("main.cpp",
                 "#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN\n#include <doctest/doctest.h>\n");
    REQUIRE(folder.run(compiler + " -std=c++17 -c main.cpp") == 0);
  }
  /// "" if the model's own test compiles and passes, else its output.
  std::string proves(const CppModel& model) const {
    write(model, folder.path);
    if (folder.run(compiler + kFlags + model.name + "_test.cpp main.o -o proof") != 0)
      return "does not compile: " + folder.read("log.txt");
    return folder.run("./proof") == 0 ? "" : folder.read("log.txt");
  }
};

/// Adds 1e-6 of itself to the first entry other than 0 and 1 of this matrix in the header.
std::string mutant(std::string header, const std::string& matrix) {
  auto at = header.find("> " + matrix + "{");
  REQUIRE(at != std::string::npos);
  for (;; ++at) {
    at = header.find_first_of("0123456789", at);
    const auto end = header.find_first_not_of("0123456789.e-+", at);
    const std::string text = header.substr(at, end - at);
    if (text.find('.') != std::string::npos && std::abs(std::stod(text)) != 1 &&
        std::stod(text) != 0)
      return header.replace(at, end - at, fmt::format("{}", std::stod(text) * (1 + 1e-6)));
    at = end;
  }
}

System five_masses() { return compile(five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95})); }

/// Two masses in a row on the wall: a direct term, and all of A, B, C, D in use.
System two_masses() {
  Diagram d{"two masses"};
  auto u = d.input("u"), w = d.input("w");
  auto a = d.add("a", SpringMass{.mass = 3, .stiffness = 7, .damping = 0.2});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 5});
  ground(a);
  mount(b, a.child);
  a.child.force += u;
  b.child.force = w;
  d.output("xdd") = b.child.accel;
  d.output("stretch") = 0.3 * a.stretch;
  return compile(d);
}

/// Poles at 0, a controller, names that are no identifiers, inputs without effect on some outputs.
Diagram odd_names() {
  Diagram d{"a \"cart\" on\nrails \\"};
  auto u = d.input("int"), w = d.input("3 w", 2);
  auto cart = d.add("κ", SpringMass{.mass = 2, .stiffness = 3, .parent_mass = 1});
  auto K = d.add("K", Lti{.A = -2 * Eigen::MatrixXd::Identity(2, 2),
                          .B = Eigen::MatrixXd::Identity(2, 2),
                          .C = Eigen::RowVector2d(1, 3)});
  K.in = w;
  cart.parent.force = -K.out - u;
  d.output("class") = cart.parent.position;
  d.output("class.") = cart.stretch;
  d.output("K") = K.out;
  return d;
}

/// No states: a gain.
Diagram gain() {
  Diagram d{"gain"};
  auto u = d.input("u", 2);
  auto body = d.add("body", SpringMass{.mass = 1, .stiffness = 0, .parent_mass = 4});
  body.child.accel = 0;
  body.parent.accel = 0;
  d.output("y", 2) = 2.5 * u;
  return d;
}

}  // namespace

TEST_CASE("generated models compile without warnings and pass their own test") {
  Diagram modes{"just modes"};
  ground(modes.add("z", SpringMass{.mass = 1, .stiffness = 4}));
  for (const std::string& compiler : compilers()) {
    INFO(compiler);
    const Workshop shop(compiler);
    CHECK(shop.proves(generate_cpp(five_masses(), {.name = "masses", .sample_time = 0.1})) == "");
    CHECK(shop.proves(generate_cpp(compile(odd_names()), {.name = "odd", .sample_time = 0.01})) ==
          "");
    CHECK(shop.proves(generate_cpp(compile(gain()), {.name = "gain", .sample_time = 1})) == "");
    CHECK(shop.proves(generate_cpp(compile(modes), {.name = "modes", .sample_time = 1})) == "");
  }
}

TEST_CASE("names that the test's own or the C library's might meet") {
  Diagram d{"names"};
  auto body = d.add("body", SpringMass{.mass = 2, .stiffness = 3});
  ground(body);
  for (const char* name : {"NULL", "NAN", "EOF", "errno", "sin", "link", "index", "signal", "A"})
    body.child.force += d.input(name);
  d.output("stdout") = body.stretch;
  const System system = compile(d);
  for (const std::string& compiler : compilers()) {
    INFO(compiler);
    const Workshop shop(compiler);
    for (const char* name : {"A", "poles"}) {
      INFO(name);
      CHECK(shop.proves(generate_cpp(system, {.name = name, .sample_time = 0.1})) == "");
    }
    // After any includes of a program.
    shop.folder.write("behind.cpp",
                      "#include <cerrno>\n#include <cmath>\n#include <csignal>\n#include <cstdio>\n"
                      "#include <strings.h>\n#include <unistd.h>\n#include \"poles.hpp\"\n"
                      "static_assert(poles::in::errno_ == 3 && poles::in::sin == 4);\n");
    CHECK(shop.folder.run(compiler + " -std=c++17 -c behind.cpp") == 0);
  }
}

TEST_CASE("a generated test is a program of its own") {
  const auto available = compilers();
  if (available.empty()) return;
  const Folder folder;
  write(generate_cpp(five_masses(), {.name = "masses", .states = CppStates::model}), folder.path);
  CHECK(folder.run(available.back() + " -std=c++17 masses_test.cpp -o proof && ./proof") == 0);
}

TEST_CASE("the generated test fails where one number of the header is wrong") {
  const auto available = compilers();
  if (available.empty()) return;
  const Workshop shop(available[0]);
  for (const CppStates states : {CppStates::modes, CppStates::model}) {
    CppModel model =
        generate_cpp(two_masses(), {.name = "masses", .sample_time = 0.1, .states = states});
    const std::string header = model.header;
    for (const char* matrix : {"A", "B", "C", "D", "A_h", "B_h"}) {
      INFO(matrix);
      model.header = mutant(header, matrix);
      const std::string said = shop.proves(model);
      CHECK(said.find("does not compile") == std::string::npos);
      CHECK(said.find("FAILURE!") != std::string::npos);
    }
  }
}

TEST_CASE("generated models of random scenes") {
  const auto available = compilers();
  if (available.empty()) return;
  const Workshop shop(available[0]);
  int tried = 0;
  for (std::uint64_t seed = 1; tried < 3; ++seed) {
    RandomOptions options = random_options(seed);
    options.incomplete = false;
    const System system = compile(random_diagram(options).build());
    if (system.order() == 0) continue;
    ++tried;
    INFO("seed ", seed);
    CHECK(shop.proves(generate_cpp(system, {.name = "scene", .sample_time = 0.01})) == "");
  }
}
