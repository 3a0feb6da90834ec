// Generated C++ as text: names, choice of states, refusals. That it compiles and is right is proved
// by compiling it: tests/interop/generated_cpp.cpp and examples/15_generated_code.cpp.
#include <doctest/doctest.h>

#include <cstdlib>
#include <set>
#include <titop/emit/cpp/form.hpp>
#include <titop/emit/cpp/test.hpp>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/literals.hpp>
#include <titop/titop.hpp>

#include "support/five_masses.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

System five_masses() { return compile(five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95})); }

bool refused(const System& system, const CppOptions& options,
             std::initializer_list<std::string_view> names) {
  return says(error_of([&] { generate_cpp(system, options); }), Code::bad_value, names);
}

}  // namespace

TEST_CASE("every name gets an identifier of its own") {
  const std::vector<std::string> names = {
      "U(3)", "U_3",           "z1.stretch", "3",      "class", "",     "a__b",  "_x",
      "κ",    "A.C1.accel(2)", "U(3)",       "a\"b\\", "std",   "NULL", "errno", "sin"};
  const std::vector<std::string> words = emit::identifiers(names);
  REQUIRE(words.size() == names.size());
  CHECK(words[0] == "U_3");
  CHECK(words[1] == "U_3_2");
  CHECK(words[2] == "z1_stretch");
  CHECK(words[3] == "n3");
  CHECK(words[4] == "class_");
  CHECK(words[9] == "A_C1_accel_2");
  CHECK(words[13] == "NULL_");
  CHECK(words[14] == "errno_");
  CHECK(words[15] == "sin");  // in a namespace of its own, where a function may have the name
  for (const std::string& word : words) CHECK(emit::is_identifier(word));
  CHECK(std::set<std::string>(words.begin(), words.end()).size() == words.size());
}

TEST_CASE("each language has its own words") {
  using emit::Language;
  for (const char* name : {"A", "B", "C", "D", "poles", "link2", "sink", "sinful", "model"})
    CHECK(emit::is_namespace(name));
  for (const char* name : {"selected", "strut", "sigma", "timer", "model_t", "SAT_1", "EARTH"})
    CHECK(emit::is_namespace(name));
  // Declared by the includes of generated tests: functions, types, macros, and their variants.
  for (const char* name :
       {"select",         "finite",        "clone",     "FILE",        "timex",    "uint",
        "ushort",         "sincos",        "exp10",     "exp10f",      "getline",  "realpath",
        "canonicalize",   "canonicalizel", "fmul",      "fadd",        "fsub",     "fdiv",
        "f32addf64",      "timespec",      "timeval",   "sinf128",     "strtod_l", "fopen64",
        "getc_unlocked",  "asctime_r",     "pthread_t", "sched_yield", "SIGHUP",   "EIO",
        "CLOCK_REALTIME", "M_PIl"}) {
    CAPTURE(name);
    CHECK(!emit::is_namespace(name));
  }
  // Keywords of C++ are names elsewhere, and the other way round.
  for (const char* name : {"int", "class", "linux", "NULL"}) {
    CHECK(!emit::is_identifier(name));
    CHECK(emit::is_identifier(name, Language::matlab));
  }
  for (const char* name : {"end", "function", "otherwise", "endif", "until", "zeros"}) {
    CHECK(!emit::is_identifier(name, Language::matlab));
    CHECK(emit::is_identifier(name));
  }
  for (const char* name : {"lambda", "None", "def", "numpy", "pathlib", "random", "types"}) {
    CHECK(!emit::is_identifier(name, Language::python));
    CHECK(emit::is_identifier(name));
  }
  CHECK(emit::is_identifier("int", Language::python));
  CHECK(emit::is_identifier(std::string(63, 'a'), Language::matlab));
  CHECK(!emit::is_identifier(std::string(64, 'a'), Language::matlab));
  for (const char* name : {"", "1a", "_a", "a b", "\xce\xba"})
    for (const Language language : {Language::cpp, Language::matlab, Language::python})
      CHECK(!emit::is_identifier(name, language));
}

TEST_CASE("numbers read back to the last bit and are no integers") {
  for (const double x : {1.0, -0.0, 0.1, 1e22, 12345678901234567890.0, 5e-324, 1.0 / 3})
    CHECK(std::strtod(emit::number(x).c_str(), nullptr) == x);
  for (const double x : {HUGE_VAL, -HUGE_VAL, std::nan("")})
    CHECK_THROWS_AS(emit::number(x), Error);  // inf.0 would not compile
  CHECK(emit::number(2) == "2.0");
  CHECK(emit::number(-0.0) == "-0.0");
  CHECK(emit::quoted("a\"b\\c\n1") == "\"a\\\"b\\\\c\\0121\"");
}

TEST_CASE("tolerances of the test end at 1e-6; checks that need more are replaced by a comment") {
  // xdot = -x + u, y = x.
  emit::ModelForm form;
  form.A = -MatrixXd::Identity(1, 1), form.B = form.C = -form.A, form.D = MatrixXd::Zero(1, 1);
  emit::add_hold(form, 0.1);
  const emit::Naming names{"lag", "lag", {"x"}, {"u"}, {"y"}, 0.1};
  emit::Expected expected;
  expected.poles.resize(1);
  expected.poles[0].s = -1, expected.poles[0].omega = 1;
  expected.points.s = {1, 3};
  expected.points.exact = {MatrixXcd::Constant(1, 1, 0.5), MatrixXcd::Constant(1, 1, 0.25)};
  expected.static_gain = MatrixXd::Identity(1, 1);
  expected.inputs = expected.outputs = MatrixXd::Zero(1, 2);
  const auto has = [&](const char* words) {
    return emit::test_text(names, form, expected).find(words) != std::string::npos;
  };
  CHECK(has("TEST_CASE(\"lag: static gain\")"));
  CHECK(has("std::vector<std::size_t>{0}"));
  CHECK(has("TEST_CASE(\"lag: step against derivative\")"));
  CHECK(has("TEST_CASE(\"lag: trajectory\")"));
  expected.poles[0].omega = 1e12;
  CHECK(!has("TEST_CASE(\"lag: step against derivative\")"));
  CHECK(has("\n// step against derivative"));  // why
  expected.poles[0].omega = 1;
  form.error = form.static_error = form.step_error = 2e-7;
  CHECK(has("tolerance = 1.0e-06"));
  form.static_error = HUGE_VAL, form.step_error = 1e-3;
  CHECK(has("\n// static gain"));
  CHECK(has("\n// trajectory, and step against derivative"));
  CHECK(!has("TEST_CASE(\"lag: static gain\")"));
  CHECK(!has("TEST_CASE(\"lag: trajectory\")"));
  // A pole that A does not have is not accepted by a tolerance that is too wide.
  expected.poles[0].s = -1.001;
  CHECK(has("std::vector<std::size_t>{}"));
}

TEST_CASE("modes where they are cheaper, the model's own states on request") {
  const System system = five_masses();
  const CppModel modes = generate_cpp(system, {.name = "masses", .sample_time = 0.1});
  CHECK(modes.modal);
  // A and A_h in blocks 3 x 10; the nonzero entries of B, C, D and B_h.
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
  CHECK(refused(system, {.name = "cart", .states = CppStates::modes},
                {"cart", "CppStates::automatic"}));
}

TEST_CASE("without inputs or outputs nothing is measured, and the header states it") {
  Diagram d{"just modes"};
  ground(d.add("z", SpringMass{.mass = 1, .stiffness = 4}));
  const System system = compile(d);
  const CppModel model = generate_cpp(system, {.name = "z", .sample_time = 0.1});
  CHECK(model.header.find("0.0e+00") == std::string::npos);  // no error, not one of 0
  CHECK(refused(system, {.name = "z", .states = CppStates::modes}, {"z", "CppStates::automatic"}));
}

TEST_CASE("an output is silent if it is so at all points, not at one") {
  // The relative acceleration over a spring of 1e10 rad/s is (omega / 1e10)^2 of the motion: lost
  // in rounding at the slow points, all there is at the fast ones.
  Diagram d{"stiff"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 1});
  auto z2 = d.add("z2", SpringMass{.mass = 1, .stiffness = 1e20});
  ground(z1);
  mount(z2, z1.child);
  z2.child.force = u;
  d.output("relative") = z2.child.accel - z1.child.accel;
  d.output("nothing") = z1.child.accel - 3.0 * z1.child.accel + 2.0 * z1.child.accel;
  const System system = compile(d);
  const emit::Points points = emit::response_points(system, system.poles());
  CHECK(points.silent_outputs == std::vector<Eigen::Index>{1});
  CHECK(points.silent_inputs.empty());
}

TEST_CASE("without a static gain of A alone: no check of it, and the other checks stay") {
  // y = (1 / s + 0.3 / s^2) u as A^2 = 0. In double the elimination of A meets a pivot that is
  // exactly 0.
  Diagram d{"nilpotent"};
  auto K = d.add("K", Lti{.A = Eigen::Matrix2d{{0.3, -0.9}, {0.1, -0.3}},
                          .B = Eigen::Vector2d(1, 0),
                          .C = Eigen::RowVector2d(1, 0)});
  K.in = d.input("u");
  d.output("y") = K.out;
  const CppModel model = generate_cpp(compile(d), {.name = "nilpotent", .sample_time = 0.1});
  CHECK(model.test.find("TEST_CASE(\"nilpotent: transfer\")") != std::string::npos);
  CHECK(model.test.find("TEST_CASE(\"nilpotent: static gain\")") == std::string::npos);

  emit::ModelForm form;
  form.A = MatrixXd::Zero(2, 2), form.A(0, 1) = 1;
  form.B = MatrixXd::Ones(2, 1), form.C = MatrixXd::Ones(1, 2), form.D = MatrixXd::Zero(1, 1);
  emit::Points points;
  points.s = {1.0};
  points.exact = {MatrixXcd::Constant(1, 1, 3)};  // 1/s + 1/s + 1/s^2
  CHECK(emit::response_error(form, points) <= 1e-15);
  CHECK(emit::static_error(form, MatrixXd::Ones(1, 1), points) == HUGE_VAL);
}

TEST_CASE("exact zeros at rest are not compared with their own rounding") {
  emit::Points points;
  points.s = {1.0};
  points.exact = {MatrixXcd::Ones(2, 3)};
  points.silent_inputs = {2};
  const MatrixXd gain{{1, 1e-17, 1}, {1e-16, 1e-20, 0}};
  const emit::Points rest = emit::at_rest(points, gain);
  CHECK(rest.silent_outputs == std::vector<Eigen::Index>{1});
  CHECK(rest.silent_inputs == std::vector<Eigen::Index>{2, 1});
}

TEST_CASE("invalid names and times are refused, all together") {
  const System system = five_masses();
  for (const char* name :
       {"", "a b", "1a", "int", "_a", "a__b", "a-b", "NULL", "NAN", "EOF", "errno", "sin", "sinf",
        "sinl", "link", "index", "signal", "size_t", "doctest"})
    CHECK(refused(system, {.name = name}, {std::string("\"") + name + "\""}));
  CHECK(refused(system, {.name = "x", .sample_time = -1}, {"-1 s"}));
  try {
    generate_cpp(system, {.name = "if", .sample_time = HUGE_VAL});
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.mistakes().size() == 2);
  }
  CHECK_THROWS_AS(write(generate_cpp(system), "/no/such/folder"), Error);
}
