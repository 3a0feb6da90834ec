// A model that loses digits in A, B, C, D: every file of it reports that, and generated code is
// refused with a way out that works.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <titop/titop.hpp>

#include "support/folder.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;

namespace {

/// A chain in which every other mass is `heavy` times as heavy as its neighbours.
Diagram chain(double heavy, const std::string& input = "u") {
  Diagram d{"uneven"};
  const auto u = d.input(input);
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 10; ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1), SpringMass{.mass = i % 2 ? heavy : 1.0,
                                                            .stiffness = 100.0 + i,
                                                            .damping = 0.1,
                                                            .parent_mass = 0.5}));
    i == 0 ? ground(z[0]) : mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
  }
  z[4].child.force += u;
  d.output("last") = z.back().child.accel;
  d.output("first") = z.front().stretch;
  return d;
}
constexpr double kFarApart = 1e12;

std::vector<std::string> lines_with(const std::string& text, const std::string& words) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find(words) != std::string::npos) found.push_back(line);
  return found;
}

/// The files of a system, as text.
struct Files {
  explicit Files(const System& system) {
    const Folder folder;
    write_matlab(system, folder.path / "m.m");
    write_numpy(system, folder.path, "m");
    matlab = folder.read("m.m"), numpy = folder.read("m.py");
    write_matlab(system.state_space(), folder.path / "m.m");
    write_numpy(system.state_space(), folder.path, "m");
    plain_matlab = folder.read("m.m"), plain_numpy = folder.read("m.py");
  }
  std::string matlab, numpy;              ///< of the system
  std::string plain_matlab, plain_numpy;  ///< of its state_space(), of which nothing is known
};

}  // namespace

TEST_CASE("digits lost by A, B, C, D are reported at the head of files and in the JSON notes") {
  const System system = compile(chain(kFarApart));
  const std::vector<std::string> warnings = dense_warnings(system);
  REQUIRE(!warnings.empty());
  CHECK(
      has_names(warnings[0], {"A, B, C, D", "u", at_s(system.dense_certificate().dense_error_s)}));
  const Files files(system);
  for (const std::string& text : warnings) {
    CHECK(lines_with(files.matlab, text) == std::vector{"  % Warning: " + text});
    CHECK(lines_with(files.numpy, text) == std::vector{"# Warning: " + text});
  }
  CHECK(files.matlab.find("% Warning") < files.matlab.find("m.n ="));
  CHECK(files.numpy.find("# Warning") < files.numpy.find("import"));
  CHECK(lines_with(files.plain_matlab, "Warning").empty());
  CHECK(lines_with(files.plain_numpy, "Warning").empty());
  std::vector<std::string> noted;
  const nlohmann::json model = nlohmann::json::parse(model_json(system));
  for (const auto& note : model.at("notes"))
    if (note.at("pass") == "dense" && note.at("kind") == "warning")
      noted.push_back(note.at("text"));
  CHECK(!noted.empty());
  for (const std::string& text : noted)
    CHECK(std::count(warnings.begin(), warnings.end(), text) == 1);
}

TEST_CASE("a model that keeps its digits is written without a word") {
  const System system = compile(chain(1));
  CHECK(dense_warnings(system).empty());
  const Files files(system);
  CHECK(files.matlab == files.plain_matlab);
  CHECK(files.numpy == files.plain_numpy);
}

TEST_CASE("a warning stays in its comment, whatever the names in it") {
  const System system = compile(chain(kFarApart, "u\nimport os\r\xC3("));
  const Files files(system);
  const auto named = lines_with(files.numpy, "import os");
  REQUIRE(named.size() >= 2);
  for (const std::string& line : named) {
    CHECK(line.rfind(&line == &named.back() ? "    \"u" : "# Warning: ", 0) == 0);
    CHECK(line.find("u\\x0aimport os\\x0d\\xc3(") != std::string::npos);
  }
  CHECK(files.matlab.find("\nimport os") == std::string::npos);
  CHECK(files.matlab.find('\r') == std::string::npos);
}

TEST_CASE("generated code of few digits is refused, and the band that matters is a way out") {
  const Diagram d = chain(kFarApart);
  const System system = compile(d);
  CHECK(says(error_of([&] { generate_cpp(system, {.name = "uneven"}); }), Code::bad_value,
             {"A, B, C, D", "uneven", "compile(d, Scene{.band_hz = {low, high}})",
              "System::transfer", "apply", "simulate"}));
  const ReducedSystem small = compile(d, Scene{.outputs = {"last"}, .band_hz = {0.2, 10}});
  const StateSpace m = small.state_space();
  Diagram of_lti{"small"};
  auto model = of_lti.add("model", Lti{.A = m.A, .B = m.B, .C = m.C, .D = m.D});
  model.in = of_lti.input("u");
  of_lti.output("y") = model.out;
  const System again = compile(of_lti);
  CHECK(generate_cpp(again, {.name = "small"}).error <= 1e-12);
  // 1e-3 of each pair's peak on the ray of the damping floor: here, near it, of the same pair.
  const std::complex<double> s = 2 * std::numbers::pi * std::complex<double>(0.002, 1);
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50).row(0);
  const Eigen::MatrixXd off = (again.state_space().transfer(s) - exact).cwiseAbs();
  CHECK((off.array() <= 1e-3 * small.bound().peak.array()).all());
}
