// Finite models against distributed beams over a band, and the choice of elements and modes.
#include <doctest/doctest.h>

#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/rng.hpp"

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
  elbow.torque = -900 * elbow.angle - 4 * elbow.rate + d.input("T");
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
double error_on_grid(const std::function<MatrixXcd(Complex)>& model, const System& exact,
                     const Scene& scene, const MatrixXd& peak) {
  constexpr int kPoints = 200;
  const double zeta = scene.damping_floor, high = 2 * std::numbers::pi * scene.band_hz[1];
  double worst = 0;
  for (int k = 1; k <= kPoints; ++k) {
    const Complex s = high * k / kPoints * Complex(zeta, std::sqrt(1 - zeta * zeta));
    const MatrixXd off = (model(s) - exact.transfer(s)).cwiseAbs();
    worst = std::max(worst, off.cwiseQuotient(peak).maxCoeff());
  }
  return worst;
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
    CHECK(error_on_grid([&](Complex s) { return finite.transfer(s); }, exact, kScene, e.peak) <=
          e.worst);
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
    CHECK(error_on_grid([&](Complex s) { return r.system.transfer(s); }, exact, scene,
                        r.error.peak) <= accuracy);
    REQUIRE(r.beams.size() == 2);
    CHECK(r.beams[0].name == "upper");
    CHECK(r.beams[0].elements > r.beams[1].elements);
    CHECK(r.system.order() > order);
    order = r.system.order();
  }
}

TEST_CASE("random arms of distributed beams: the error is below the accuracy") {
  titop_test::Rng rng(52);
  for (int links = 1; links <= 3; ++links) {
    Diagram d{"random arm"};
    auto hub = d.add("hub", RigidBody{.mass = rng.between(5, 200),
                                      .inertia = rng.between(1, 20) * Matrix3d::Identity(),
                                      .children = {{"a", {rng.between(0, 1), 0, 0.1}}}});
    hub.parent.force = -d.input("F", 6);
    std::vector<DualPort<6>> sites = {hub.child("a")};
    for (int i = 0; i < links; ++i) {
      const double length = rng.between(0.5, 4), diameter = rng.between(0.02, 0.1);
      auto b = d.add("b" + std::to_string(i + 1), link(length, diameter));
      mount(b, sites.back(), Rotation::about(kZ, rng.between(-2, 2)));
      sites.push_back(b.child("C"));
    }
    auto tip = d.add(
        "tip", RigidBody{.mass = rng.between(0.1, 20), .inertia = 0.05 * Matrix3d::Identity()});
    mount(tip, sites.back());
    d.output("hub", 6) = hub.parent.accel;
    const Scene scene{.band_hz = {0, rng.between(2, 20)}, .accuracy = 1e-3};
    const ReducedBeams r = reduce_beams(d, scene);
    INFO(links << '\n' << to_string(r));
    CHECK(r.error.worst <= scene.accuracy);
    CHECK(error_on_grid([&](Complex s) { return r.system.transfer(s); }, compile(d), scene,
                        r.error.peak) <= scene.accuracy);
  }
}
