#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/compiler/solve/null_rows.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/notes.hpp"

/// Scenes with many points without mass: the cost of each does not depend on their number.

using namespace titop;
using namespace titop_test;

namespace {

using Complex = std::complex<double>;

constexpr double kMass = 1, kDamping = 0.1;   // of a link of the row [kg], [N s/m]
constexpr double kBracket = 0.5, kInner = 3;  // mass that it adds, its spring
constexpr double kOuter = 4, kTip = 1;        // beyond the massless point
constexpr double kSeries = kInner * kOuter / (kInner + kOuter);  // both springs

double stiffness(int i) { return 10.0 + i % 3; }

/// A row from the wall on, or spokes on the first mass. Every mass has a side branch: a spring, a
/// point without mass, another spring with a mass. The force u acts on the last mass of the row.
Diagram branches(int count, bool spokes = false) {
  Diagram d{"branches"};
  auto u = d.input("u");
  const Param last = d.param("last", stiffness(count - 1));
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < count; ++i) {
    z.push_back(d.add(fmt::format("z{}", i),
                      SpringMass{.mass = kMass,
                                 .stiffness = i == count - 1 ? Value(last) : Value(stiffness(i)),
                                 .damping = kDamping}));
    if (i == 0)
      ground(z[0].parent);
    else
      mount(z.back(), z[spokes ? 0 : z.size() - 2].child);
    auto inner =
        d.add(fmt::format("inner{}", i), SpringMass{.mass = kBracket, .stiffness = kInner});
    auto outer = d.add(fmt::format("outer{}", i), SpringMass{.mass = kTip, .stiffness = kOuter});
    weld(inner.child, z.back().child);
    outer.parent.accel = inner.parent.accel;
    inner.parent.force = -outer.parent.force;
  }
  z.back().child.force += u;
  d.output("a") = z.back().child.accel;
  return d;
}

/// From u to a of the row, link by link from the wall on: dynamic stiffnesses side by side add up,
/// those in a row add up by their inverses.
Complex by_links(int count, Complex s) {
  const auto one_after_the_other = [](Complex a, Complex b) { return a * b / (a + b); };
  const Complex own = (kMass + kBracket) * s * s + one_after_the_other(kSeries, kTip * s * s);
  Complex seen = 0;
  for (int i = 0; i < count; ++i) {
    const Complex spring = stiffness(i) + kDamping * s;
    seen = own + (i == 0 ? spring : one_after_the_other(spring, seen));
  }
  return s * s / seen;
}

/// Cost of the points' dependences among rows: fronts visited, and entries of the rows.
struct Cost {
  std::size_t points = 0, fronts = 0, entries = 0;
};

Cost cost_of_dependences(const Diagram& diagram) {
  const auto data = detail::compile_graph(diagram.graph(), {.minimize_up_to = 0});
  const detail::Skeleton& k = *data->skeleton;
  REQUIRE(k.before_reduce);
  solve::Matrices<double> m;
  for (const auto& block : data->numbers.blocks) {
    m.direct.push_back(&block->D);
    m.output.push_back(&block->C);
  }
  const solve::JointRows<double> rows(k.stage.graph, *k.before_reduce, data->numbers.coefficients,
                                      std::move(m));
  const solve::NullRows null =
      solve::null_rows({k.before_reduce->plan, rows, nullptr, solve::NoPivot::patch});
  Cost cost{null.y.size(), null.fronts};
  for (const solve::SparseRow& y : null.y) cost.entries += y.size();
  return cost;
}

}  // namespace

TEST_CASE("massless: the dependences of many points cost as much for each as those of few") {
  for (const bool spokes : {false, true}) {
    CAPTURE(spokes);
    const Cost few = cost_of_dependences(branches(40, spokes)),
               many = cost_of_dependences(branches(640, spokes));
    CHECK(few.points == 40);
    CHECK(many.points == 640);
    // The row's ends differ from its middle: a tenth for that.
    CHECK(static_cast<double>(many.fronts) <= 1.1 * 16 * static_cast<double>(few.fronts));
    CHECK(static_cast<double>(many.entries) <= 1.1 * 16 * static_cast<double>(few.entries));
    // A point's dependence is among its own springs and its sum of forces.
    CHECK(many.entries <= 8 * many.points);
  }
}

TEST_CASE("massless: a long row with a massless point at every mass, against link by link") {
  constexpr int kCount = 600;
  const System system = compile(branches(kCount), {.minimize_up_to = 0});
  CHECK(system.order() == 4 * kCount);  // two masses for each massless point
  for (const Complex s : {Complex(0.2, 0.3), Complex(0.1, 1.7), Complex(0.5, 4)})
    CHECK(relative(system.transfer(s)(0, 0), by_links(kCount, s)) <= 1e-12);
}

TEST_CASE(
    "massless: an update compiles again, with the reason, as a fresh compile to the last bit") {
  const auto scene = [](double last) {
    Diagram d{"series"};
    auto u = d.input("u");
    const Param k = d.param("k", last);
    auto z = d.add("z", SpringMass{.mass = 7, .stiffness = 30}),
         far = d.add("far", SpringMass{.mass = 2, .stiffness = k});
    auto tip = d.add("tip", SpringMass{.mass = 3, .stiffness = 20});
    ground(far);
    mount(tip, far.child);
    z.child.accel = tip.child.accel;
    tip.child.force = -z.child.force;
    z.parent.force = -u;
    d.output("a") = tip.child.accel;
    return d;
  };
  const System updated = compile(scene(50)).update({{"k", 60.0}});
  CAPTURE(updated.log());
  // The log names the new value; all is compiled again, as the scene has been reduced.
  CHECK(noted(updated, Note::Kind::info, "update", {"k = 60"}));
  CHECK(noted(updated, Note::Kind::info, "reduce"));
  CHECK(updated.certificate().plans_renewed == 1);
  StateSpace of_update, fresh;
  updated.write(of_update);
  compile(scene(60)).write(fresh);
  CHECK(difference(of_update, fresh) == "");
}
