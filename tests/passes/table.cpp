// The table of passes is the whole truth: those that run are those listed, in their order.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <titop/titop.hpp>
#include <vector>

#include "support/five_masses.hpp"
#include "support/folder.hpp"

using namespace titop;

namespace {

using Names = std::vector<std::string>;

Names ran(const std::vector<std::pair<std::string, double>>& list) {
  Names names;
  for (const auto& [name, seconds] : list) {
    names.push_back(name);
    CHECK(seconds >= 0);
  }
  return names;
}

constexpr const char* kOfDense = "state_space() is called";

/// Those of the table that run always, and these.
Names listed(const std::set<std::string>& optional) {
  Names names;
  for (const CompilerPass& pass : compiler_passes())
    if (std::string(pass.when).empty() || optional.contains(pass.name)) names.push_back(pass.name);
  return names;
}

Names listed_of_dense() {
  Names names;
  for (const CompilerPass& pass : compiler_passes())
    if (std::string(pass.when) == kOfDense) names.push_back(pass.name);
  return names;
}

/// The wall, a spring, a point without mass, another spring, a mass: the joint system is singular.
Diagram without_mass() {
  Diagram d{"without mass"};
  auto first = d.add("first", SpringMass{.mass = 7, .stiffness = 3});
  auto second = d.add("second", SpringMass{.mass = 2, .stiffness = 5});
  first.child.accel = 0;
  second.parent.accel = first.parent.accel;
  first.parent.force = -second.parent.force;
  second.child.force = d.input("u");
  d.output("x") = second.stretch;
  return d;
}

/// Two rigid bodies welded at two points.
Diagram welded_twice() {
  Diagram d{"welded twice"};
  const auto body = [](const Eigen::Vector3d& left, const Eigen::Vector3d& right) {
    return RigidBody{
        .mass = 3, .inertia = {1, 2, 3}, .children = {{"left", left}, {"right", right}}};
  };
  auto a = d.add("a", body({1, 0, 0}, {-1, 0, 0})), b = d.add("b", body({2, 0, 0}, {-2, 0, 0}));
  a.parent.force = -d.input("F", 6);
  mount(b, a.child("left"));
  weld(b.child("right"), a.child("right"));
  d.output("acc", 6) = b.child("left").accel;
  return d;
}

Diagram with_parameter() {
  Diagram d{"parameter"};
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = d.param("k", 4)});
  ground(z);
  z.child.force = d.input("u");
  d.output("x") = z.stretch;
  return d;
}

Diagram with_beam() {
  Diagram d{"beam"};
  auto beam = d.add("beam", FlexibleBody(Beam{.length = 1,
                                              .section = rectangle(0.1, 0.1),
                                              .material = {.E = 7e10, .nu = 0.3, .rho = 2700},
                                              .elements = 2,
                                              .modes = {.kept = 2}}));
  ground(beam);
  beam.child.force = d.input("F", 6);
  d.output("a", 6) = beam.child.accel;
  return d;
}

}  // namespace

TEST_CASE("the passes that ran are the passes listed") {
  const struct {
    Diagram diagram;
    std::set<std::string> optional;
  } scenes[] = {{titop_test::third_of_five(titop_test::kMasses, titop_test::kStiffnesses), {}},
                {with_parameter(), {"depend"}},
                {without_mass(), {"reduce"}},
                {welded_twice(), {"forces"}},
                {with_beam(), {"digits"}}};
  for (const auto& scene : scenes) {
    CAPTURE(scene.diagram.graph().name);
    const System system = compile(scene.diagram);
    CHECK(ran(system.seconds()) == listed(scene.optional));
    CHECK(ran(system.dense_seconds()) == listed_of_dense());
  }
}

TEST_CASE("no note is of a pass that is not listed") {
  const System system = compile(without_mass());
  std::set<std::string> names;
  for (const CompilerPass& pass : compiler_passes()) names.insert(pass.name);
  for (const auto& notes : {system.notes(), system.dense_notes()})
    for (const Note& note : notes) CHECK(names.contains(note.pass));
}

TEST_CASE("the drawings of the passes are those of the first passes listed") {
  const titop_test::Folder folder;
  compile(with_parameter(), {.dump_to = folder.path.string()});
  Names drawn;
  for (const auto& file : std::filesystem::directory_iterator(folder.path))
    drawn.push_back(file.path().filename().string());
  std::sort(drawn.begin(), drawn.end());
  REQUIRE(drawn.size() >= 2);
  CHECK(drawn.front() == "00-diagram.dot");
  for (std::size_t i = 1; i < drawn.size(); ++i)
    CHECK(drawn[i].substr(3) == compiler_passes()[i - 1].name + std::string(".dot"));
  CHECK(compiler_passes()[drawn.size() - 1].name == std::string("layout"));
}

TEST_CASE("docs/architecture.md lists the same passes with the same promises") {
  std::ifstream file(std::filesystem::path(TITOP_SOURCE_DIR) / "docs" / "architecture.md");
  std::string line;
  while (std::getline(file, line) && line != "| pass | afterwards |") {
  }
  std::getline(file, line);  // the rule under the heading
  for (const CompilerPass& pass : compiler_passes()) {
    const std::string when = pass.when;
    REQUIRE(std::getline(file, line));
    CHECK(line == std::string("| ") + pass.name + " | " + pass.promise +
                      (when.empty() ? " |" : " (if " + when + ") |"));
  }
  std::getline(file, line);
  CHECK(line.empty());
}
