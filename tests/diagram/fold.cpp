// Large diagrams, folded by subtree: how much is shown, and that nothing is lost.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <optional>

#include "scenes.hpp"
#include "support/folder.hpp"

using namespace titop_test;

namespace {

SpringMass::Handle add(Diagram& d, int number) {
  return d.add("z" + std::to_string(number), SpringMass{});
}

/// Block i is mounted on block (i - 1) / arms: a chain for one arm, a tree for two, a star for
/// many.
Diagram tree(int blocks, int arms, bool backwards = false) {
  Diagram d{"tree"};
  auto u = d.input("u");
  std::vector<int> order(static_cast<std::size_t>(blocks));
  std::iota(order.begin(), order.end(), 0);
  if (backwards) std::reverse(order.begin(), order.end());
  std::vector<std::optional<SpringMass::Handle>> z(order.size());
  for (const int i : order) z[static_cast<std::size_t>(i)] = add(d, i + 1);
  for (const int i : order) {
    auto& here = *z[static_cast<std::size_t>(i)];
    if (i == 0)
      ground(here);
    else
      mount(here, z[static_cast<std::size_t>((i - 1) / arms)]->child);
  }
  z.back()->child.force += u;
  d.output("x") = z.back()->position;
  return d;
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

struct Shown {
  int blocks = 0, boxes = 0, inside = 0, edges = 0;
};

Shown shown(const std::string& text) {
  Shown s{count(text, "\" [shape=plain label=<\n"), count(text, "[shape=box3d"), 0,
          count(text, "\" -> ") + count(text, ":s -> ") + count(text, ":n -> ")};
  for (std::size_t at = text.find("▤ "); at != std::string::npos; at = text.find("▤ ", at + 1))
    if (std::isdigit(static_cast<unsigned char>(text[at + 4])))
      s.inside += std::stoi(text.substr(at + 4));
  return s;
}

}  // namespace

TEST_CASE("10, 100 and 1000 blocks: as many boxes as asked for, and all blocks are in one") {
  for (const int arms : {1, 2, 3, 1000})
    for (const int blocks : {10, 100, 1000})
      for (const int most : {2, 5, 12, 40}) {
        INFO(arms, " arms, ", blocks, " blocks, at most ", most);
        const Shown s = shown(to_dot(tree(blocks, arms), {.fold = most}));
        // A star has its centre and at most eight boxes.
        const int wide = arms == 1000 && most < blocks ? 9 : 1000;
        CHECK(s.blocks + s.boxes == std::min({most, blocks, wide}));
        CHECK(s.blocks + s.inside == blocks);
        // Two wires to a box's parent, one from the sum before it; ground, input, output.
        CHECK(s.edges <= 3 * (s.blocks + s.boxes) + 3);
      }
}

TEST_CASE("a chain shows its first blocks, then one box for the rest") {
  const std::string text = to_dot(tree(100, 1), {.fold = 12});
  CHECK(text.find("<B>z12 …</B>") != std::string::npos);
  CHECK(text.find("▤ 89 blocks, 178 states<BR/>SpringMass ×89") != std::string::npos);
  CHECK(text.find("\"z11\":c0a:s -> \"fold z12\" [") != std::string::npos);
  CHECK(text.find("\"fold z12\" -> \"input u\" [dir=back") != std::string::npos);
  CHECK(text.find("\"fold z12\" -> \"output x\" [") != std::string::npos);
}

TEST_CASE("a star shows some arms, and the others as one box with as many wires") {
  const std::string text = to_dot(tree(1000, 1000), {.fold = 5});
  const Shown s = shown(text);
  CHECK(s.blocks == 4);
  CHECK(s.boxes == 1);
  CHECK(text.find("▤ 996 blocks, 1992 states") != std::string::npos);
  CHECK(count(text, "label=\" ×996 \"") == 2);  // accelerations down, forces up
}

TEST_CASE("the largest subtrees are opened first") {
  Diagram d{"lopsided"};
  auto root = add(d, 1);
  ground(root);
  auto left = add(d, 2), right = add(d, 3);
  mount(left, root.child);
  mount(right, root.child);
  for (int i = 0; i < 3; ++i) mount(add(d, 10 + i), left.child);
  for (int i = 0; i < 9; ++i) mount(add(d, 20 + i), right.child);
  const std::string text = to_dot(d, {.fold = 6});
  CHECK(text.find("▤ 4 blocks") != std::string::npos);  // left and its three
  CHECK(text.find("<B>z2 …</B>") != std::string::npos);
  CHECK(shown(text).blocks + shown(text).boxes == 6);
  CHECK(text.find("  \"z3\" [shape=plain") != std::string::npos);
}

TEST_CASE("inputs and outputs of one box share an ellipse, others stay") {
  Diagram d{"ends"};
  auto u = d.input("u");
  auto z = add(d, 1);
  ground(z);
  z.child.force = u;
  for (int i = 2; i <= 50; ++i) {
    auto arm = add(d, i);
    mount(arm, z.child);
    arm.child.force += d.input("f" + std::to_string(i));
    d.output("x" + std::to_string(i)) = arm.position;
  }
  d.output("x1") = z.position;
  const std::string text = to_dot(d, {.fold = 2});
  CHECK(count(text, "shape=ellipse") == 4);
  CHECK(text.find("f2 … f50") != std::string::npos);
  CHECK(text.find("x2 … x50") != std::string::npos);
  CHECK(text.find("(49)") != std::string::npos);
}

TEST_CASE("bodies, joints and controllers fold into their parents") {
  for (const auto& scene : {five_masses, fig12, spacecraft, robot_joint, controlled, pinned}) {
    const Diagram d = scene();
    const std::string whole = to_dot(d);
    CHECK(to_dot(d, {.fold = 100}) == whole);
    const int blocks = shown(whole).blocks;
    for (const auto& text : {to_dot(d, {.fold = 2}), to_dot(compile(d).stage(), {.fold = 2})}) {
      INFO(d.name());
      CHECK(shown(text).blocks + shown(text).boxes == std::min(2, blocks));
    }
  }
}

TEST_CASE("folded text is stable: the same on every run, whatever the order of adds") {
  for (const int arms : {1, 2, 1000}) {
    const std::string text = to_dot(tree(1000, arms), {.fold = 12});
    CHECK(text == to_dot(tree(1000, arms), {.fold = 12}));
    CHECK(text == to_dot(tree(1000, arms, true), {.fold = 12}));
  }
}

TEST_CASE("Graphviz reads folded diagrams without a word") {
  if (std::system("dot -V > /dev/null 2>&1") != 0) {
    MESSAGE("SKIPPED: dot (Debian package graphviz) is not installed");
    return;
  }
  const Folder folder;
  for (const int arms : {1, 2, 1000}) {
    folder.write("a.dot", to_dot(compile(tree(200, arms)).stage(), {.fold = 20}));
    CHECK(folder.run("dot -Tsvg a.dot -o a.svg 2>&1 | grep -iv font >words; ! test -s words") == 0);
    CHECK(folder.read("a.svg").find("</svg>") != std::string::npos);
  }
}
