// Generated C++ as text: names, choice of states, refusals. That it compiles and is right is proved
// by compiling it: tests/interop/generated_cpp.cpp and examples/15_generated_code.cpp.
#include <doctest/doctest.h>

#include <cstdlib>
#include <set>
#include <titop/compiler/emit/cpp/text.hpp>
#include <titop/titop.hpp>

#include "support/five_masses.hpp"

using namespace titop;
using namespace titop_test;

namespace {

System five_masses() { return compile(five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95})); }

bool refused(const System& system, const CppOptions& options, const std::string& words) {
  try {
    generate_cpp(system, options);
  } catch (const Error& error) {
    CHECK(error.has(Code::bad_value));
    return std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

}  // namespace

TEST_CASE("every name gets an identifier of its own") {
  const std::vector<std::string> names = {"U(3)", "U_3",    "z1.stretch", "3", "class",
                                          "",     "a__b",   "_x",         "κ", "A.C1.accel(2)",
                                          "U(3)", "a\"b\\", "std"};
  const std::vector<std::string> words = emit::identifiers(names);
  REQUIRE(words.size() == names.size());
  CHECK(words[0] == "U_3");
  CHECK(words[1] == "U_3_2");
  CHECK(words[2] == "z1_stretch");
  CHECK(words[3] == "n3");
  CHECK(words[4] == "class_");
  CHECK(words[9] == "A_C1_accel_2");
  for (const std::string& word : words) CHECK(emit::is_identifier(word));
  CHECK(std::set<std::string>(words.begin(), words.end()).size() == words.size());
}

TEST_CASE("numbers read back to the last bit and are no integers") {
  for (const double x : {1.0, -0.0, 0.1, 1e22, 12345678901234567890.0, 5e-324, 1.0 / 3})
    CHECK(std::strtod(emit::number(x).c_str(), nullptr) == x);
  CHECK(emit::number(2) == "2.0");
  CHECK(emit::number(-0.0) == "-0.0");
  CHECK(emit::quoted("a\"b\\c\n1") == "\"a\\\"b\\\\c\\0121\"");
}

TEST_CASE("modes where they are cheaper, the model's own states on request") {
  const System system = five_masses();
  const CppModel modes = generate_cpp(system, {.name = "masses", .sample_time = 0.1});
  CHECK(modes.modal);
  // A and A_h in blocks 3 x 10; B, C, D and B_h by what is not 0.
  CHECK(modes.products <= 2 * 30 + 10 + 10 + 60 + 6);
  const CppModel own =
      generate_cpp(system, {.name = "masses", .sample_time = 0.1, .states = CppStates::model});
  CHECK(!own.modal);
  CHECK(own.products > modes.products);
  CHECK(own.header.find("inline constexpr std::size_t z1_stretch = 0;") != std::string::npos);
  CHECK(own.error <= 1e-12);
  CHECK(modes.error <= 1e-12);
}

TEST_CASE("free rigid motion has no modes: the model's own states, or a refusal") {
  Diagram d{"cart"};
  auto u = d.input("u");
  auto cart = d.add("cart", SpringMass{.mass = 2, .stiffness = 3, .parent_mass = 1});
  auto K = d.add("K", Lti{.A = -Eigen::MatrixXd::Identity(1, 1),
                          .B = Eigen::MatrixXd::Identity(1, 1),
                          .C = Eigen::MatrixXd::Identity(1, 1)});
  K.in = u;
  cart.parent.force = -K.out;
  d.output("x") = cart.parent.position;
  const System system = compile(d);
  CHECK(!generate_cpp(system, {.name = "cart"}).modal);
  CHECK(refused(system, {.name = "cart", .states = CppStates::modes}, "modes of cart lose digits"));
}

TEST_CASE("what cannot be a name or a time is refused, all together") {
  const System system = five_masses();
  for (const char* name : {"", "a b", "1a", "int", "_a", "a__b", "a-b"})
    CHECK(refused(system, {.name = name}, "cannot be the name of generated code"));
  CHECK(refused(system, {.name = "x", .sample_time = -1}, "a sample time of -1 s"));
  try {
    generate_cpp(system, {.name = "if", .sample_time = HUGE_VAL});
  } catch (const Error& error) {
    CHECK(error.mistakes().size() == 2);
  }
  CHECK_THROWS_AS(write(generate_cpp(system), "/no/such/folder"), Error);
}
