#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <titop/compiler/loops/along.hpp>
#include <titop/compiler/loops/lines.hpp>
#include <titop/compiler/loops/redundant.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>

#include "assembly.hpp"
#include "stages.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// Trusses of rigid bars on pins: no body belongs to one loop alone, and most loop equations are
/// redundant. The work of the passes grows with the structure, independent of names.

using namespace loops_test;
using namespace titop;

namespace {

using titop::linalg::at;

/// Order of the bars' names: one bay after the other; all rails, then rungs, then braces; or in no
/// order.
enum class Names { along, by_kind, scrambled };

std::string name_of_bar(Names names, int number, const Vector3d& v) {
  if (names == Names::along) return std::to_string(number);
  if (names == Names::by_kind)
    return (v.y() == 0 ? "rail" : v.x() == 0 ? "rung" : "slope") + std::to_string(1000 + number);
  auto mixed = static_cast<std::uint32_t>(number + 1) * 2654435761u;
  mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
  return std::to_string(mixed ^ (mixed >> 13));
}

/// A braced truss of rigid bars on pins, all in one plane: every bay has two loops.
struct Truss {
  int bays = 1;
  bool crossed = false;  ///< a second brace, which constrains nothing in addition to the first
  int read = -1;         ///< the bar of which a force is an output
  bool axial = true;     ///< of it along the bar; else all
  Names names = Names::along;
  std::uint64_t shuffled = 0;  ///< in this order the bars are put together; 0: bay by bay
};

Diagram truss(const Truss& shape) {
  Diagram d{"truss"};
  RigidBody node{.mass = 5, .inertia = 0.1 * Matrix3d::Identity()};
  for (int k = 0; k < 8; ++k) node.children.push_back({"p" + std::to_string(k)});
  std::vector<BodyHandle> nodes;
  for (int k = 0; k < 2 * (shape.bays + 1); ++k)
    nodes.push_back(d.add("N" + std::to_string(k), node));
  std::vector<int> used(nodes.size(), 0);
  std::vector<char> placed(nodes.size(), 0);
  placed[0] = 1;
  int count = 0;
  const auto bar = [&](int a, int b) {  // two nodes side by side, bays 1 m apart
    const Vector3d v(b / 2 - a / 2, b % 2 - a % 2, 0);
    const Rotation R = Rotation::about({0, 0, 1}, std::atan2(v.y(), v.x()));
    const std::string name = name_of_bar(shape.names, count, v);
    const auto site = [&](int n) {
      return nodes[at(n)].child("p" + std::to_string(used[at(n)]++));
    };
    auto start = d.add("P" + name, Hinge{{0, 0, 1}}), end = d.add("Q" + name, Hinge{{0, 0, 1}});
    start.torque = 0.3 * start.rate + 5.0 * start.angle;
    end.torque = 0.2 * end.rate + 3.0 * end.angle;
    auto body = d.add("B" + name, RigidBody{.mass = 4,
                                            .inertia = Vector3d(0.1, 1.4, 1.4).asDiagonal(),
                                            .PA = v.norm() / 2 * Vector3d::UnitX(),
                                            .children = {{"C", v.norm() * Vector3d::UnitX()}}});
    mount(start, site(a), R), mount(body, start.child), mount(end, body.child("C"));
    if (placed[at(b)])
      weld(end.child, site(b), R);
    else
      mount(nodes[at(b)], end.child, R.inverse());
    placed[at(b)] = 1;
    if (count++ != shape.read) return;
    if (shape.axial)
      d.output("F") = body.parent.force.along({1, 0, 0});
    else
      d.output("F", 6) = body.parent.force;
  };
  std::vector<std::pair<int, int>> bars{{0, 1}};
  for (int i = 1; i <= shape.bays; ++i) {
    bars.insert(
        bars.end(),
        {{2 * i - 2, 2 * i}, {2 * i - 1, 2 * i + 1}, {2 * i, 2 * i + 1}, {2 * i - 2, 2 * i + 1}});
    if (shape.crossed) bars.emplace_back(2 * i - 1, 2 * i);
  }
  if (titop_test::Rng rng(shape.shuffled); shape.shuffled > 0)
    for (std::size_t i = bars.size(); i > 1; --i)
      std::swap(bars[i - 1], bars[at(rng.below(static_cast<int>(i)))]);
  for (const auto& [a, b] : bars) bar(a, b);
  nodes.front().parent.force = -d.input("U", 6);
  d.output("a", 6) = nodes.back().child("p7").accel;
  return d;
}

}  // namespace

TEST_CASE("a truss of rigid bars: along twenty followers nothing is taken for rounding") {
  for (const auto& [crossed, bays, names] : {std::tuple(false, 3, Names::along),
                                             {true, 3, Names::along},
                                             {false, 20, Names::along},
                                             {true, 20, Names::along},
                                             {false, 20, Names::by_kind},
                                             {true, 20, Names::by_kind},
                                             {false, 20, Names::scrambled},
                                             {true, 20, Names::scrambled}}) {
    CAPTURE(crossed);
    CAPTURE(bays);
    CAPTURE(static_cast<int>(names));
    Truss shape{bays, crossed};
    shape.names = names;
    const System system = compile(truss(shape), {.minimize_up_to = 0});
    CHECK(system.order() == 2 * 2 * (bays + 1));  // the nodes turn, the bars do not
    const Complex s(0.3, 40);
    CHECK(by_hand::transfer_error({system.state_space().transfer(s)},
                                  {system.transfer(s, Precision::digits50)}) <= 1e-8);
  }
}

TEST_CASE("a truss of rigid bars: dependent coordinates are found in linear time") {
  for (const bool crossed : {false, true})
    for (const Names names : {Names::along, Names::by_kind, Names::scrambled}) {
      CAPTURE(crossed);
      CAPTURE(static_cast<int>(names));
      const auto count = [&](int bays) {
        Truss shape{bays, crossed};
        shape.names = names;
        return entries(truss(shape));
      };
      CHECK(count(80) <= 4.4 * count(20));
    }
}

TEST_CASE("a truss of rigid bars: who reads an internal force is found by a few sums of them all") {
  using namespace titop_test;
  for (const int read : {3, 40}) {
    CAPTURE(read);
    // A hinge constrains five directions; round each of 24 triangles the three out of the plane are
    // held already.
    const System system = compile(truss({12, false, read}), {.minimize_up_to = 0});
    CHECK(noted(system, Note::Kind::info, "forces", {"32", "72"}));
    const std::string force = "B" + std::to_string(read) + ".parent.force";
    CHECK(says(compile_error(truss({12, false, read, false})), Code::kinematic_loop, {"F", force}));
    CHECK(says(compile_error(truss({12, true, read})), Code::kinematic_loop, {"F", force}));
  }
}

namespace {

/// The chains of a truss, as pass `chains` meets them.
struct Chains {
  Stage stage;
  loops::SumExpander sums;
  loops::Motion motion;
  std::vector<loops::Closing> closings = {};

  explicit Chains(const Truss& shape)
      : stage(passes::split(passes::lower(passes::check(as_written(truss(shape).graph()))))),
        sums(stage.graph),
        motion(stage.graph, stage.values, sums) {
    for (const auto& tie : motion.ties())
      if (tie.closes) closings.push_back(motion.closing(tie));
  }

  /// Columns that are open at once if redundancy is decided in this order.
  int widest(const std::vector<int>& order) const {
    using namespace loops;
    std::vector<RelationRows> lines;
    for (const int c : order) lines.push_back(line_of(closings[at(c)]));
    const auto all = [](const ScalarColumn&) { return ColumnRole{Relations::Role::coordinate, 0}; };
    int result = 0;
    for (Component& c : components(lines, all)) {
      scale(c.relations);
      result = std::max(result, redundancy(c.relations).widest);
    }
    return result;
  }
  std::vector<int> by_name() const {
    std::vector<int> order;
    for (int c = 0; c < static_cast<int>(closings.size()); ++c) order.push_back(c);
    return order;
  }
};

}  // namespace

TEST_CASE("a truss of rigid bars: redundancy is decided along it, independent of names") {
  // A bay shares some ten columns with the next; put together in no order, the front has two ends.
  for (const std::uint64_t shuffled : {0u, 1u, 2u})
    for (const Names names : {Names::along, Names::by_kind, Names::scrambled})
      for (const int bays : {20, 80}) {
        CAPTURE(shuffled);
        CAPTURE(static_cast<int>(names));
        CAPTURE(bays);
        Truss shape{bays, true};
        shape.names = names, shape.shuffled = shuffled;
        const Chains chains(shape);
        CHECK(chains.widest(along(chains.closings)) <= 24);
        if (bays == 80 && shuffled == 0 && names != Names::along)
          CHECK(chains.widest(chains.by_name()) >= 200);  // it is the order that does it
      }
}

TEST_CASE("a truss of rigid bars: every chain is decided after those that its way round uses") {
  for (const Names names : {Names::along, Names::by_kind, Names::scrambled}) {
    CAPTURE(static_cast<int>(names));
    Truss shape{30, true};
    shape.names = names, shape.shuffled = 3;
    const Chains chains(shape);
    std::map<int, int> turn;  // of the closing equations that are decided
    int used = 0;
    for (const int c : along(chains.closings)) {
      const auto& closing = chains.closings[at(c)];
      for (const int e : closing.equations)
        if (e != closing.tie->equation &&
            std::any_of(chains.closings.begin(), chains.closings.end(),
                        [&](const auto& other) { return other.tie->equation == e; })) {
          CHECK(turn.contains(e));
          ++used;
        }
      turn.emplace(closing.tie->equation, static_cast<int>(turn.size()));
    }
    CHECK(turn.size() == chains.closings.size());
    CHECK(used >= 30);
  }
}
