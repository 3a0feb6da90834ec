// Finite models against distributed beams over a band, and the choice of elements and modes.
#include <doctest/doctest.h>

#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

#include "random_beams.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

ExactBeam link(double length, double diameter) {
  return {.length = length,
          .section = tube(diameter, 0.8 * diameter),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .damping = {.mass = 0.02, .stiffness = 2e-5}};
}

const Vector3d kZ(0, 0, 1);

/// Two links on a free hub, the elbow on a spring; `add` makes the links.
template <class Add>
Diagram arm(Add add) {
  Diagram d{"arm"};
  auto hub = d.add("hub", RigidBody{.mass = 60,
                                    .inertia = Vector3d(5, 6, 7).asDiagonal(),
                                    .children = {{"arm", {0.4, 0, 0}}}});
  auto upper = add(d, "upper", link(3, 0.08)), lower = add(d, "lower", link(2, 0.05));
  hub.parent.force = -d.input("F", 6);
  mount(upper, hub.child("arm"));
  auto elbow = hinge(d, "elbow", lower, upper.child("C"), Rotation::about(kZ, 0.7), kZ);
  elbow.torque = 900 * elbow.angle + 4 * elbow.rate + d.input("T");
  auto hand = d.add("hand", RigidBody{.mass = 3, .inertia = 0.02 * Matrix3d::Identity()});
  mount(hand, lower.child("C"));
  d.output("hub", 6) = hub.parent.accel;
  d.output("hand", 6) = hand.parent.accel;
  return d;
}

Diagram exact_arm() {
  return arm([](Diagram& d, const char* name, const ExactBeam& b) { return d.add(name, b); });
}

Diagram arm_of(int elements) {
  return arm([&](Diagram& d, const char* name, const ExactBeam& b) {
    return BodyHandle(d.add(name, FlexibleBody{with_elements(b, elements)}));
  });
}

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
  auto b = d.add("b", link(1, 0.05));
  b.parent.accel = 0;
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
  CHECK(says(error_of([&] { compare(finite, compile(d), kScene); }), Code::bad_value,
             {"inputs", "7", "6"}));
  CHECK(says(error_of([&] { compare(exact, exact, kScene); }), Code::not_rational, {"upper"}));
  CHECK(says(error_of([&] { compare(finite, exact, {.band_hz = {2, 1}}); }), Code::bad_value, {}));
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

TEST_CASE("compare refuses what has no gain at 0, and models without inputs or outputs") {
  const auto free_beam = [](bool position, auto spec) {
    Diagram d{"free beam"};
    auto b = d.add("b", spec);
    b.parent.force = -d.input("F", 6);
    d.output("y", 6) = position ? b.parent.position : b.parent.rate;
    return d;
  };
  const FlexibleBody finite{with_elements(link(1, 0.05), 4)};
  for (const bool position : {true, false}) {
    const System a = compile(free_beam(position, finite)),
                 b = compile(free_beam(position, link(1, 0.05)));
    const auto at = [&](double low) { return compare(a, b, {.band_hz = {low, 50}}); };
    CHECK(says(error_of([&] { at(0); }), Code::bad_value, {"y(", "F(", "0 Hz", "band_hz"}));
    CHECK(at(1).worst < 1);
  }
  Diagram none{"none"};
  none.add("b", link(1, 0.05)).parent.accel = 0;
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
  part.add("upper", link(3, 0.08));
  CHECK(refused([&] { damping_of_assembly(part, "upper.parent", {{"C", "upper.C"}}, 0.003); }));
}
