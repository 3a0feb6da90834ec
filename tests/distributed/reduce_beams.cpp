// Finite models against distributed beams over a band, and the choice of elements and modes.
#include <doctest/doctest.h>

#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

#include "random_beams.hpp"
#include "scenes/two_link_arm.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace scenes::two_link_arm;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

Diagram exact_arm() { return arm(upper, lower); }

const Scene kScene{.band_hz = {0, 40}, .accuracy = 1e-3};

/// Largest error of a pair over this peak on the ray, on a fine grid of its own.
template <class Model>
double error_on_grid(const Model& model, const System& exact, const ErrorBound& e) {
  return titop_test::error_at(model, exact, titop_test::steps_of(kScene, 200), e.peak);
}

}  // namespace

TEST_CASE("compare: the error of a mesh falls with h^4, and bounds that of a fine grid") {
  const System exact = compile(exact_arm());
  std::vector<double> worst;
  for (const int elements : {2, 4, 8}) {
    const System finite = compile(arm_of(elements));
    const ErrorBound e = compare(finite, exact, kScene);
    worst.push_back(e.worst);
    CHECK(e.kind == BoundKind::estimate);
    CHECK(e.pairs.rows() == 12);
    CHECK(e.pairs.maxCoeff() == e.worst);
    CHECK(error_on_grid(finite, exact, e) <= e.worst);
  }
  CHECK(worst[0] / worst[1] >= 8);
  CHECK(worst[1] / worst[2] >= 8);
}

TEST_CASE("compare refuses other inputs, and two models without a state space") {
  const System exact = compile(exact_arm()), finite = compile(arm_of(2));
  Diagram d{"one beam"};
  auto b = d.add("b", lower);
  b.parent.accel = 0;
  b.child.force.linear = d.input("F", 3);
  d.output("a", 6) = b.child.accel;
  CHECK(says(error_of([&] { compare(finite, compile(d), kScene); }), Code::bad_value,
             {"inputs", "6", "3"}));
  CHECK(says(error_of([&] { compare(exact, exact, kScene); }), Code::not_rational, {"upper"}));
  CHECK(says(error_of([&] { compare(finite, exact, {.band_hz = {2, 1}}); }), Code::bad_value, {}));
  CHECK(says(error_of([&] { reduce_beams(arm_of(2), kScene); }), Code::bad_value,
             {"ExactBeam", "FlexibleBody"}));
}

TEST_CASE("reduce_beams: elements and modes for an accuracy against the distributed beams") {
  const Diagram d = exact_arm();
  const System exact = compile(d);
  int order = 0;
  for (const double accuracy : {1e-2, 1e-3}) {
    Scene scene = kScene;
    scene.accuracy = accuracy;
    const ReducedBeams r = reduce_beams(d, scene);
    INFO(to_string(r));
    CHECK(r.error.worst <= accuracy);
    CHECK(r.of_beams.worst <= accuracy / 2);
    CHECK(error_on_grid(r.system, exact, r.error) <= accuracy);
    REQUIRE(r.beams.size() == 2);
    CHECK(r.beams[0].name == "upper");
    CHECK(r.beams[0].elements > r.beams[1].elements);
    CHECK(r.system.order() > order);
    order = r.system.order();
  }
}

TEST_CASE("reduce_beams refuses an accuracy that 200 elements do not reach, and names the beam") {
  Diagram d{"one beam"};
  auto b = d.add("boom", upper);
  b.parent.accel = 0;
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
  CHECK(says(error_of([&] {
               reduce_beams(d, {.band_hz = {0, 100}, .accuracy = 1e-11});
             }),
             Code::bad_value, {"boom", "200", "accuracy"}));
}

TEST_CASE("compare refuses what has no gain at 0, and models without inputs or outputs") {
  const auto free_beam = [](bool position, auto spec) {
    Diagram d{"free beam"};
    auto b = d.add("b", spec);
    b.parent.force = -d.input("F", 6);
    d.output("y", 6) = position ? b.parent.position : b.parent.rate;
    return d;
  };
  const FlexibleBody finite{with_elements(lower, 4)};
  for (const bool position : {true, false}) {
    const System a = compile(free_beam(position, finite)), b = compile(free_beam(position, lower));
    const auto at = [&](double low) { return compare(a, b, {.band_hz = {low, 50}}); };
    CHECK(says(error_of([&] { at(0); }), Code::bad_value, {"y(", "F(", "0 Hz", "band_hz"}));
    CHECK(at(1).worst < 1);
  }
  Diagram none{"none"};
  none.add("b", lower).parent.accel = 0;
  CHECK(says(error_of([&] { compare(compile(none), compile(none), kScene); }), Code::not_rational,
             {"b"}));
}

TEST_CASE("what needs a state space refuses distributed beams, and names them") {
  const Diagram d = exact_arm();
  const System system = compile(d);
  const auto refused = [](auto f) { return says(error_of(f), Code::not_rational, {"upper"}); };
  CHECK(refused([&] { exact_order(d.graph()); }));
  CHECK(refused([&] { derivatives(system, {}); }));
  CHECK(refused([&] { report_html(system, {.diagrams = false}); }));
  CHECK(refused([&] { generate_cpp(system); }));
  CHECK(refused([&] { mode_shapes(system, std::vector<int>{0}); }));
  CHECK(refused([&] { interface_bracket([](Lumping) { return exact_arm(); }); }));
  Diagram part{"part"};
  part.add("upper", upper);
  CHECK(refused([&] { damping_of_assembly(part, "upper.parent", {{"C", "upper.C"}}, 0.003); }));
}
