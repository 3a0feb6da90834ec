#include <doctest/doctest.h>

#include <set>

#include "scenes.hpp"
#include "support/close.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

const titop::Scene question{.band_hz = {0, 60}};

titop::Scene with_accuracy(titop::Scene scene, double accuracy) {
  scene.accuracy = accuracy;
  return scene;
}

}  // namespace

TEST_CASE("a frame of three beams: the error stays below its bound, the bound near the error") {
  const Diagram d = frame(slim_beam());
  const Truth truth = frame_by_hand(slim_beam());
  for (const double accuracy : {1e-1, 1e-3, 1e-6}) {
    const titop::Scene scene = with_accuracy(question, accuracy);
    const ReducedSystem r = compile(d, scene);
    CAPTURE(accuracy);
    CHECK(r.bound().worst <= 1.2 * check_beside(r, scene, truth).error);
    CHECK(r.order() <= r.full().order() / 4);
    CHECK(r.inputs() == compile(d).inputs());
    CHECK(r.outputs() == compile(d).outputs());
  }
}

TEST_CASE("more accuracy never gives a smaller order, and modes of the band are the full ones") {
  const Diagram d = frame(slim_beam());
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  const std::vector<WhatIf> table = what_if(d, question, accuracies);
  REQUIRE(table.size() == accuracies.size());
  for (std::size_t k = 1; k < table.size(); ++k) CHECK(table[k].order >= table[k - 1].order);
  const std::vector<Pole> full = compile(d).poles();
  for (const WhatIf& w : table) {
    CHECK(w.bound <= w.accuracy);
    for (const KeptMode& m : w.system.modes()) {
      if (!m.exact) {
        CHECK(m.hertz > question.band_hz[1]);
        continue;
      }
      double nearest = 1;
      for (const Pole& p : full) nearest = std::min(nearest, relative(m.hertz, p.hertz));
      CHECK(nearest <= 1e-9);
    }
  }
}

TEST_CASE("vectors of an input and of an output come one by one: the first may do") {
  // Three equal masses on equal springs, one of three modes in the band; driven at the end, read at
  // the first: of the two dimensions above the band each accuracy takes as many as it needs.
  Diagram d{"chain"};
  auto U = d.input("U");
  std::vector<SpringMass::Handle> z;
  for (int i = 1; i <= 3; ++i)
    z.push_back(d.add("z" + std::to_string(i), SpringMass{.mass = 1.0, .stiffness = 1000.0}));
  z[0].parent.accel = 0;
  mount(z[1], z[0].child);
  mount(z[2], z[1].child);
  z[2].child.force = U;
  d.output("a") = z[0].child.accel;
  std::vector<double> accuracies;
  for (int k = 4; k <= 36; ++k) accuracies.push_back(std::pow(10, -0.25 * k));
  std::set<int> orders;
  for (const WhatIf& w : what_if(d, titop::Scene{.band_hz = {0, 4}}, accuracies))
    orders.insert(w.order);
  CHECK(orders == std::set<int>{2, 4, 6});
}

TEST_CASE("damped in every mode: the error stays below its bound, stable stays stable") {
  const Diagram d = frame(slim_beam(6, 0.005));
  const titop::Scene scene = with_accuracy(question, 1e-4);
  const ReducedSystem r = compile(d, scene);
  check_beside(r, scene, frame_by_hand(slim_beam(6, 0.005)));
  CHECK(r.order() < r.full().order() / 2);
  for (const Pole& p : poles(r.state_space())) CHECK(p.s.real() < 0);
}

TEST_CASE("a theorem counts every pole: more samples, and the bound holds") {
  const Diagram d = frame(slim_beam(5));
  titop::Scene scene = with_accuracy(question, 1e-3);
  const ReducedSystem estimate = compile(d, scene);
  scene.bound = BoundKind::theorem;
  const ReducedSystem theorem = compile(d, scene);
  CHECK(theorem.bound().kind == BoundKind::theorem);
  CHECK(theorem.bound().samples > 1.2 * estimate.bound().samples);
  check_beside(theorem, scene, frame_by_hand(slim_beam(5)));
}

TEST_CASE("the result does not depend on units") {
  // Lengths in mm and masses in g: the same modes, ports scaled.
  const FlexibleBody beam = slim_beam(5);
  const DataUnits units{.length = 1000, .mass = 1000, .time = 1};
  const ReducedSystem a = compile(frame(beam), with_accuracy(question, 1e-4));
  const ReducedSystem b =
      compile(frame(FlexibleBody(scaled(beam.data(), units))), with_accuracy(question, 1e-4));
  CHECK(a.order() == b.order());
  CHECK(relative(a.bound().worst, b.bound().worst) <= 1e-3);
}
