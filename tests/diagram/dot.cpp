#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <titop/compiler/diagram/text.hpp>

#include "scenes.hpp"

using namespace titop_test;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The lines that contain `part`, as one text.
std::string lines_with(const std::string& text, const std::string& part) {
  std::istringstream in(text);
  std::string line, found;
  while (std::getline(in, line))
    if (has(line, part)) found += line + "\n";
  return found;
}

/// The lines of one block: from its name to the end of its table.
std::string block(const std::string& text, const std::string& name) {
  const std::size_t start = text.find("  \"" + name + "\" [shape=plain");
  REQUIRE(start != std::string::npos);
  return text.substr(start, text.find("</TABLE>>];", start) - start);
}

std::string compiled(const Diagram& d) { return to_dot(compile(d).stage()); }

std::string file(const std::string& path) {
  std::ifstream in(path);
  REQUIRE(in);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Fig. 7 with adds and equations in another order.
Diagram five_masses_shuffled() {
  Diagram d{"five masses"};
  auto z5 = d.add("z5", SpringMass{.mass = 5.0, .stiffness = 95.0});
  auto z3 = d.add("z3", SpringMass{.mass = 3.0, .stiffness = 33.0});
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1.0, .stiffness = 10.0});
  auto z4 = d.add("z4", SpringMass{.mass = 4.0, .stiffness = 20.0});
  auto z2 = d.add("z2", SpringMass{.mass = 2.0, .stiffness = 26.0});
  z2.child.force = u + z5.parent.force + z4.parent.force;
  d.output("x3") = z3.stretch + z1.stretch;
  z5.parent.accel = z2.child.accel;
  z3.parent.accel = z1.child.accel;
  z1.child.force = z3.parent.force - u + z2.parent.force;
  z4.parent.accel = z2.child.accel;
  z2.parent.accel = z1.child.accel;
  z1.parent.accel = 0;
  return d;
}

}  // namespace

TEST_CASE("Fig. 12 is drawn as stored") {
  const std::string path = TITOP_SOURCE_DIR "/tests/diagram/fig12.dot";
  const std::string text = compiled(fig12());
  CHECK_MESSAGE(text == file(path), "if the new picture is right, store this as ", path, ":\n",
                text);
}

TEST_CASE("the order of adds and equations leaves no trace") {
  CHECK(to_dot(five_masses()) == to_dot(five_masses_shuffled()));
  CHECK(compiled(five_masses()) == compiled(five_masses_shuffled()));
  CHECK(compiled(spacecraft()) == compiled(spacecraft()));
}

TEST_CASE("algebraic loops have one colour and one number each") {
  const std::string text = compiled(five_masses());
  CHECK(has(block(text, "z1"), "↻1"));
  CHECK(has(block(text, "z3"), "↻1"));
  CHECK(has(block(text, "z4"), "↻2"));
  CHECK_FALSE(has(block(text, "z4"), "↻1"));
  CHECK_FALSE(has(text, "↻3"));
  const std::string to_z4 = lines_with(text, "-> \"z4\":c1a");
  const std::string to_z3 = lines_with(text, "-> \"z3\":c1a");
  const auto colour_of = [](int loop) {
    return "color=\"" + std::string(diagram::colour::loop_line(loop)) + "\"";
  };
  CHECK(has(to_z3, colour_of(1)));
  CHECK(has(to_z4, colour_of(2)));
  CHECK(has(text, "algebraic loop"));
  CHECK_FALSE(has(to_dot(five_masses()), "↻"));
}

TEST_CASE("inverted channels are marked, and only those") {
  const std::string text = compiled(fig12());
  CHECK(has(block(text, "z1"), "parent ⁻¹"));
  CHECK_FALSE(has(block(text, "z1"), "child ⁻¹"));
  CHECK(has(block(text, "z2"), "child ⁻¹"));
  CHECK_FALSE(has(block(text, "z2"), "parent ⁻¹"));
  CHECK(has(block(compiled(robot_joint()), "drive"), "torque ⁻¹"));
  CHECK_FALSE(has(compiled(five_masses()), "⁻¹"));
}

TEST_CASE("inactive parts are grey and dashed") {
  const std::string text = compiled(controlled());
  const std::string grey(diagram::colour::removed);
  CHECK(has(block(text, "lone"), "set aside"));
  CHECK(has(block(text, "lone"), "STYLE=\"dashed\""));
  CHECK_FALSE(has(block(text, "z1"), "set aside"));
  const std::string unseen = lines_with(compiled(five_masses()), ">stretch</");
  CHECK(std::count(unseen.begin(), unseen.end(), '\n') == 5);
  CHECK(has(lines_with(unseen, grey), "stretch"));
  CHECK_FALSE(has(to_dot(controlled()), "STYLE=\"dashed\""));
}

TEST_CASE("ground, zero forces and sums") {
  const std::string text = to_dot(five_masses());
  CHECK(has(text, "\"ground z1.parent.accel\" -> \"z1\":c1a:n"));
  CHECK_FALSE(has(text, "ground z2"));
  CHECK(has(block(text, "z3"), "= 0"));
  CHECK_FALSE(has(block(text, "z1"), "= 0"));
  CHECK(has(text, "\"sum z1.child.force\" [shape=circle"));
  CHECK(has(lines_with(text, "\"sum z1.child.force\" -> \"input u\""), "taillabel=\"−\""));
  CHECK_FALSE(has(lines_with(text, "\"sum z2.child.force\" -> \"input u\""), "−"));
  const std::string pin = to_dot(pinned());
  CHECK(has(lines_with(pin, "\"ground B.parent.accel.linear\" -> "), ".linear"));
  CHECK(has(block(pin, "B"), ".angular = 0"));
}

TEST_CASE("sizes, frames, rotations and gains stand on the wires") {
  for (const std::string& text : {to_dot(spacecraft()), compiled(spacecraft())}) {
    const std::string down = lines_with(text, "\"B\":c0a:s -> ");
    CHECK(has(down, "\"gain A1.parent.accel\""));
    CHECK(has(down, "6, B"));
    CHECK(has(lines_with(text, "\"gain A1.parent.accel\" [shape=box"), "T(A1←B)"));
    CHECK(has(lines_with(text, " -> \"A1\":c1f:n"), "6, A1"));
    CHECK(has(text, "label=\"T(B←A1)\""));
    CHECK(has(text, "label=\"T(A2←B)\""));
  }
  CHECK(has(to_dot(robot_joint()), "label=\"k\""));
  CHECK(has(compiled(robot_joint()), "label=\"30\""));
  CHECK(has(to_dot(robot_joint()), "6, drive=A"));
  for (const std::string& text : {to_dot(controlled()), compiled(controlled())}) {
    CHECK(has(block(text, "error"), " −"));
    CHECK(has(block(text, "K"), "× 12"));
  }
}

TEST_CASE("a parameter keeps its sign and its factor in a drawing") {
  Diagram d{"gains"};
  auto k = d.param("k", 3.0);
  auto z = d.add("z", SpringMass{});
  auto g = d.add("g", Gain{.gain = -2.0 * k});
  ground(z);
  g.in = z.child.rate;
  z.child.force = -k * z.stretch + g.out;
  d.output("y") = 0.5 * k * z.stretch;
  const std::string text = to_dot(d);
  CHECK(has(lines_with(text, "\"gain z.child.force 2\" [shape=box"), "label=\"k\""));
  CHECK(has(lines_with(text, "\"gain z.child.force 2\" ->"), "headlabel=\"−\""));
  CHECK(has(lines_with(text, "\"gain output y\" [shape=box"), "label=\"0.5 k\""));
  CHECK(has(block(text, "g"), " × −2 k"));
}

TEST_CASE("text of any origin is quoted") {
  CHECK(diagram::quoted("a\"b\\") == "\"a\\\"b\\\\\"");
  CHECK(diagram::quoted("&lt;") == "\"&amp;lt;\"");
  CHECK(diagram::html("<b> & \"c\"") == "&lt;b&gt; &amp; &quot;c&quot;");
  CHECK(diagram::html("") == "(no name)");
  CHECK(diagram::clean("ärm→") == "ärm→");
  CHECK(diagram::clean("a\nb") ==
        "a\xEF\xBF\xBD"
        "b");
  CHECK(diagram::clean("\xC3(\xED\xA0\x80") == "\xEF\xBF\xBD(\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
}

TEST_CASE("every block, input and output is a node of its own, whatever the names") {
  Diagram d{"names"};
  d.input("u");
  auto z = d.add("input u", SpringMass{});
  d.add("a", SpringMass{});
  d.add("a", SpringMass{});
  d.add("a (2)", SpringMass{});
  d.output("u") = z.stretch;
  const std::string text = to_dot(d);
  for (const char* id : {"input u", "block input u", "a", "a (2)", "a (2) (2)", "output u"})
    CHECK(has(text, "\n  \"" + std::string(id) + "\" [shape="));
}
