#include <doctest/doctest.h>

#include "held.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Scenes that are no passive structure: controllers in the loop, dashpots without springs. Their
/// states are balanced; the reference is written out by hand.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

TEST_CASE("a structure held by a law with an actuator and a delay: small, and how far off") {
  const Held held;
  const titop::Scene scene{.band_hz = {0, 8}};
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-6};
  const std::vector<WhatIf> table = what_if(held.diagram(), scene, accuracies);
  REQUIRE(table.size() == accuracies.size());
  int before = 0;
  for (const WhatIf& w : table) {
    CAPTURE(w.accuracy);
    CHECK(w.system.full().order() == 2 * 13 + 2);
    CHECK(w.order >= before);
    before = w.order;
    CHECK(w.bound <= w.accuracy);
    const Beside fine = beside_by_hand(w.system, scene, held);
    CHECK(fine.bound <= 1);
    CHECK(fine.error <= 1.01 * w.accuracy);
    CHECK(fine.peak_low >= 0.87);
    CHECK(fine.peak_high <= 1.001);
    CHECK(rightmost(w.system.state_space()) < 0);
    CHECK(step(w.system, "kept").after == 28);
    CHECK(step(w.system, "balanced").after == w.order);
    CHECK(step(w.system, "kept").text.find("z1.parent.position") != std::string::npos);
  }
  CHECK(table.front().order <= 12);
  CHECK(before < 28);
}

TEST_CASE("all poles counted, the bound is a theorem") {
  const Held held;
  titop::Scene scene{.band_hz = {0.01, 8}, .accuracy = 1e-3, .bound = BoundKind::theorem};
  const ReducedSystem r = compile(held.diagram(), scene);
  CHECK(r.bound().kind == BoundKind::theorem);
  CHECK(beside_by_hand(r, scene, held).bound <= 1);
}

TEST_CASE("the dropped singular values bound the error far beyond the band as well") {
  // One lag after the other: hardly any band, so the model is balanced for the whole axis.
  Diagram d{"lags"};
  auto U = d.input("U");
  Complex before = 1;
  std::vector<Lti::Handle> f;
  for (int i = 0; i < 5; ++i) {
    f.push_back(d.add("f" + std::to_string(i + 1), lag(1, 1 + i)));
    if (i == 0)
      f[0].in = U;
    else
      f.back().in = f[static_cast<std::size_t>(i) - 1].out;
  }
  d.output("y") = f.back().out;
  int bounded = 0;
  for (const double accuracy : {3e-1, 3e-2, 1e-3}) {
    const ReducedSystem r =
        compile(d, titop::Scene{.band_hz = {0, 50}, .accuracy = accuracy, .damping_floor = 0.5});
    CHECK(r.order() < 5);
    CHECK(rightmost(r.state_space()) < 0);
    if (r.bound().anywhere < 0) continue;
    ++bounded;
    for (const double w : {0.0, 0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 1e4})
      for (const Complex s : {Complex(0, w), Complex(w, w), Complex(w, 0)}) {
        Complex H = before;
        for (int i = 0; i < 5; ++i) H /= s / (1.0 + i) + 1.0;
        CHECK(std::abs(r.transfer(s)(0, 0) - H) <=
              r.bound().anywhere * r.bound().peak(0, 0) * (1 + 1e-9));
      }
  }
  CHECK(bounded >= 1);
}

TEST_CASE("undamped modes have no Gramian: they are kept to the last digit, whatever the filter") {
  // A force through a chain of lags on an undamped oscillator.
  const double m = 2, k = 50;
  Diagram d{"driven"};
  auto U = d.input("U");
  auto z = d.add("z", SpringMass{.mass = m, .stiffness = k});
  auto slow = d.add("slow", lag(1, 3)), fast = d.add("fast", lag(1, 400));
  slow.in = U;
  fast.in = slow.out;
  z.parent.accel = 0;
  z.child.force = fast.out;
  d.output("x") = z.stretch;
  const titop::Scene scene{.band_hz = {0, 2}, .accuracy = 1e-4};
  const ReducedSystem r = compile(d, scene);
  CHECK(has_name(step(r, "kept").text, "2 states"));
  CHECK(r.order() == 3);  // the fast lag has gone
  double nearest = 1;
  for (const Pole& p : poles(r.state_space()))
    nearest = std::min(nearest, relative(p.s, Complex(0, std::sqrt(k / m))));
  CHECK(nearest <= 1e-12);
  REQUIRE(r.modes().size() == 2);
  CHECK(r.modes()[0].exact);
  CHECK(r.modes()[0].blocks.front().first == "z");
  CHECK(r.modes()[1].balanced);
  for (const double w : {0.0, 1.0, 4.9, 10.0}) {
    const Complex s{scene.damping_floor * w, w};
    const Complex H = 1.0 / (m * s * s + k) / (s / 3.0 + 1.0) / (s / 400.0 + 1.0);
    CHECK(std::abs(r.transfer(s)(0, 0) - H) <= 1.01e-4 * r.bound().peak(0, 0));
  }
}

TEST_CASE("free motions are kept as integrals, and refused where the band starts at 0") {
  Diagram d{"pushed"};
  auto U = d.input("U");
  auto cart = d.add("cart", SpringMass{.mass = 1, .stiffness = 90, .damping = 4, .parent_mass = 3});
  auto slow = d.add("slow", lag(1, 8)), fast = d.add("fast", lag(1, 900));
  slow.in = U;
  fast.in = slow.out;
  cart.parent.force = -fast.out;
  d.output("x") = cart.parent.position;
  titop::Scene scene{.band_hz = {0.05, 3}, .accuracy = 1e-2};
  const ReducedSystem r = compile(d, scene);
  CHECK(has_name(step(r, "kept").text, "2 integrals"));
  const auto truth = [](Complex s) {
    const Complex spring = 90.0 + 4.0 * s, seen = s * s * spring / (s * s + spring);
    return MatrixXcd::Constant(1, 1,
                               1.0 / (3.0 * s * s + seen) / (s / 8.0 + 1.0) / (s / 900.0 + 1.0));
  };
  CHECK(beside(r, scene, {truth, {}}, 4000).bound <= 1);
  CHECK(r.order() < r.full().order());
  // A pair of integrals is one block, [0 1; 0 0].
  const ModalModel modal = r.modal();
  for (const double w : {0.3, 5.0, 18.0}) {
    const Complex s{0.002 * w, w};
    CHECK(matrix_error(modal.transfer(s), r.transfer(s)) <= 1e-9);
    CHECK(matrix_error(r.state_space().transfer(s), r.transfer(s)) <= 1e-9);
  }
  scene.band_hz[0] = 0;
  CHECK(says(error_of([&] { compile(d, scene); }), Code::bad_value, {"x", "U", "Scene::band_hz"}));
}

TEST_CASE("an unstable loop stays unstable: the pole right of the axis is kept") {
  Diagram d{"unstable"};
  auto U = d.input("U");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4, .damping = 0.5});
  auto K = d.add("K", lag(30, 20));  // a positive loop: more than the spring
  K.in = z.stretch;
  z.parent.accel = 0;
  z.child.force = U + K.out;
  d.output("x") = z.stretch;
  const titop::Scene scene{.band_hz = {0, 5}, .accuracy = 1e-1};
  const ReducedSystem r = compile(d, scene);
  CHECK(has_name(step(r, "kept").text, "1 unstable"));
  const auto loop = [](double s) { return (s * s + 0.5 * s + 4) * (s / 20 + 1) - 30; };
  double low = 0, high = 30;
  for (int i = 0; i < 100; ++i) (loop((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  CHECK(relative(rightmost(r.state_space()), low) <= 1e-12);
  const auto truth = [](Complex s) {
    return MatrixXcd::Constant(1, 1, 1.0 / (s * s + 0.5 * s + 4.0 - 30.0 / (s / 20.0 + 1.0)));
  };
  CHECK(beside(r, scene, {truth, {}}, 2000).bound <= 1);
}

TEST_CASE("an oscillation that grows counts as the two states that it is") {
  // m x'' - c x' + k x = u, the dashpot driven backwards by a law.
  const double m = 1, k = 40, c = 0.8;
  Diagram d{"growing"};
  auto U = d.input("U");
  auto z = d.add("z", SpringMass{.mass = m, .stiffness = k});
  auto K = d.add("K", Lti{.D = one(c)});
  auto slow = d.add("slow", lag(1, 5));
  K.in = z.child.rate;
  slow.in = U;
  z.parent.accel = 0;
  z.child.force = slow.out + K.out;
  d.output("x") = z.stretch;
  const titop::Scene scene{.band_hz = {0, 5}, .accuracy = 1e-3};
  const ReducedSystem r = compile(d, scene);
  CHECK(has_name(step(r, "kept").text, "2 unstable"));
  const auto truth = [&](Complex s) {
    return MatrixXcd::Constant(1, 1, 1.0 / (m * s * s - c * s + k) / (s / 5.0 + 1.0));
  };
  CHECK(beside(r, scene, {truth, {}}, 2000).bound <= 1);
}

TEST_CASE("states that the scene requests are balanced whatever whole_up_to is") {
  const Held held;
  const titop::Scene scene{.band_hz = {0, 8},
                           .accuracy = 1e-2,
                           .whole_up_to = 5,
                           .keep_structure = false,
                           .balance_up_to = 28};
  const ReducedSystem r = compile(held.diagram(), scene);
  for (const ReductionStep& s : r.steps()) CHECK(s.name != "bodies");
  CHECK(beside_by_hand(r, scene, held).bound <= 1);
}

TEST_CASE("dashpots without springs, and heavy damping that is asked to be balanced") {
  // Masses in honey: a dashpot to the ground each by way of a spring-less block, springs between.
  const double m = 2, k = 300, c = 500;
  const int n = 8;
  for (const bool springs : {false, true}) {
    Diagram d{"honey"};
    auto U = d.input("U");
    std::vector<SpringMass::Handle> z;
    for (int i = 0; i < n; ++i) {
      // The first one has a dashpot only; or all of them both.
      z.push_back(
          d.add("z" + std::to_string(i + 1),
                SpringMass{.mass = m, .stiffness = i == 0 && !springs ? 0 : k, .damping = c}));
      if (i == 0)
        z[0].parent.accel = 0;
      else
        mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
    }
    z.back().child.force = U;
    d.output("v") = z.back().child.rate;
    const titop::Scene scene{.band_hz = {0.02, 20}, .accuracy = 1e-3, .keep_structure = !springs};
    const ReducedSystem r = compile(d, scene);
    const auto truth = [&](Complex s) {
      Complex below = (springs ? k : 0) + s * c;
      for (int i = 0; i + 1 < n; ++i) {
        const Complex mass = below + s * s * m, link = k + s * c;
        below = mass * link / (mass + link);
      }
      return MatrixXcd::Constant(1, 1, s / (below + s * s * m));
    };
    const Beside fine = beside(r, scene, {truth, {}}, 4000);
    CHECK(fine.bound <= 1);
    CHECK(fine.error <= 1.01e-3);
    CHECK(r.order() <= 8);
    CHECK(rightmost(r.state_space()) < 0);
    if (!springs) {
      CHECK(step(r, "kept").text.find("z1") != std::string::npos);
      continue;
    }
    titop::Scene structure = scene;
    structure.keep_structure = true;
    CHECK(r.order() <= compile(d, structure).order());
  }
}

TEST_CASE("static gain only: no states but those on the axis") {
  const Held held;
  const ReducedSystem r = compile(held.diagram(), titop::Scene{.inputs = {"R"}, .accuracy = 1e-6});
  CHECK(r.order() == 0);
  CHECK(std::abs(r.state_space().D(0, 0) - 1) <= 1e-6);  // it goes to the right place
}

TEST_CASE("a balanced model is dense and modal, and states why it is no second-order model") {
  const Held held;
  const ReducedSystem r =
      compile(held.diagram(), titop::Scene{.band_hz = {0, 8}, .accuracy = 1e-3});
  CHECK(r.inputs() == r.full().inputs());
  CHECK(r.outputs() == r.full().outputs());
  const StateSpace dense = r.state_space();
  const ModalModel modal = r.modal();
  CHECK(dense.order() == r.order());
  CHECK(modal.order() - r.order() <= 1);
  CHECK(dense.states.front() == "balanced1");
  for (const double w : {0.1, 3.0, 40.0, 1000.0}) {
    CHECK(matrix_error(dense.transfer({0, w}), r.transfer({0, w})) <= 1e-9);
    CHECK(matrix_error(modal.transfer({0, w}), r.transfer({0, w})) <= 1e-9);
  }
  CHECK(says(error_of([&] { r.second_order(); }), Code::bad_value,
             {"held", "z1.parent.position", "state_space()"}));
  double share = 0;
  for (const KeptMode& m : r.modes())
    for (const auto& [name, part] : m.blocks)
      if (name == "law" || name == "delay") share = std::max(share, part);
  CHECK(share > 0.2);
}

TEST_CASE("a slow lag beside a fast one counts where the band begins at 0") {
  Diagram d{"drift"};
  auto u = d.input("u");
  auto slow = d.add("slow", lag(0.9, 1e-5)), fast = d.add("fast", lag(1, 1e6));
  slow.in = u, fast.in = u;
  d.output("y") = slow.out + fast.out;
  for (const BoundKind kind : {BoundKind::estimate, BoundKind::theorem})
    for (const double accuracy : {2e-2, 0.3}) {
      CAPTURE(accuracy);
      const ReducedSystem r =
          compile(d, {.band_hz = {0, 100}, .accuracy = accuracy, .bound = kind});
      const auto exact = [](Complex s) { return 0.9e-5 / (s + 1e-5) + 1e6 / (s + 1e6); };
      double worst = 0;
      for (double w = 1e-9; w <= 628; w *= 1.3)
        worst = std::max(worst, std::abs(r.transfer({0, w})(0, 0) - exact({0, w})));
      CHECK(worst <= r.bound().worst * r.bound().peak(0, 0));
      CHECK(r.bound().worst <= accuracy);
    }
}
