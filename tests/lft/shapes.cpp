#include "lft/one_parameter.hpp"
#include "support/mistakes.hpp"

/// Entries of the modes' participations L_P and shapes Phi_C as parameters: least occurrences, and
/// the LFT, `update` and the derivatives against a body of other data.

using namespace lft_test;
using titop_test::error_of;
using titop_test::says;

namespace {

ModalData with_child() {
  ModalData data = boom();
  Eigen::MatrixXd Phi(6, 3);
  Phi << 0.1, 0.2, -0.3, 0.8, -0.5, 0.2, 0.3, 0.7, 0.1, 0.05, 0.1, 0.2, -0.2, 0.4, 0.3, 0.5, -0.4,
      0.1;
  data.children = {{"tip", {1.1, 0.2, 0}, Phi}};
  return data;
}

/// A hub with the boom, which carries a body.
Diagram scene(const FlexibleBody& of, Diagram d) {
  auto b = d.add("hub", hub());
  auto flexible = d.add("boom", of);
  auto load = d.add("load", RigidBody{.mass = 2, .inertia = {1, 2, 3, 0, 0, 0}, .PA = kPA});
  b.parent.force = -d.input("U", 6);
  mount(flexible, b.child, Rotation::about({0, 0, 1}, 0.5));
  mount(load, flexible.child, Rotation::about({1, 0, 0}, -0.3));
  d.output("y", 6) = b.parent.accel;
  d.output("place", 6) = load.parent.position;
  d.output("rate", 6) = load.parent.rate;
  return d;
}

/// Accelerations alone: no pair for the position.
System accelerations(const std::function<ModeValues(const Param&)>& values, double nominal) {
  Diagram d{"scene"};
  const Param p = d.param("p", nominal);
  auto b = d.add("hub", hub());
  auto flexible = d.add("boom", FlexibleBody{FlexibleBody{with_child()}, values(p)});
  auto load = d.add("load", RigidBody{.mass = 2, .inertia = {1, 2, 3, 0, 0, 0}, .PA = kPA});
  b.parent.force = -d.input("U", 6);
  mount(flexible, b.child);
  mount(load, flexible.child);
  d.output("y", 6) = b.parent.accel;
  return compile(d);
}

constexpr double kL = 0.2, kPhi = -0.2;  // L_P(1, rx ...), see below

FlexibleBody with_values(Value l, Value phi) {
  return {FlexibleBody{with_child()},
          {.L_P = {{.mode = 1, .component = 5, .value = l}},
           .Phi_C = {{"tip", {{.mode = 1, .component = 5, .value = phi}}}}}};
}

System with_parameters() {
  Diagram d{"scene"};
  const Param l = d.param("l", kL), phi = d.param("phi", kPhi);
  return compile(scene(with_values(l, phi), std::move(d)));
}

/// The same with these numbers in the data.
System with_numbers(double l, double phi) {
  ModalData data = with_child();
  data.L_P(0, 4) = l;
  data.children[0].Phi_C(4, 0) = phi;
  return compile(scene(FlexibleBody{data}, Diagram{"scene"}));
}

constexpr std::complex<double> kS{0.2, 1.7};

}  // namespace

TEST_CASE("shapes: an entry of L_P or Phi_C occurs twice, and so does a row of L_P") {
  check_one(accelerations(
                [](const Param& p) {
                  return ModeValues{.L_P = {{2, 3, -1 * p}}};
                },
                -0.8),
            percent(50), 2);
  check_one(accelerations(
                [](const Param& p) {
                  return ModeValues{.Phi_C = {{"tip", {{1, 2, 2 * p}}}}};
                },
                0.4),
            percent(80), 2);
  check_one(accelerations(
                [](const Param& p) {
                  ModeValues values;
                  const ModalData data = with_child();
                  for (int i = 0; i < 6; ++i) values.L_P.push_back({3, i + 1, data.L_P(2, i) * p});
                  return values;
                },
                1),
            percent(50), 2);
}

TEST_CASE("shapes: LFT, update and a body of other data agree, positions and rates too") {
  const System system = with_parameters();
  const Lft f = lft(system, {{"l", between(-0.5, 0.6)}, {"phi", between(-1, 1)}});
  INFO(to_string(f));
  for (const auto& [l, phi] : {std::pair(kL, kPhi), {-0.4, 0.9}, {0.5, -0.7}, {0.0, 0.0}}) {
    const ParameterList values = {{"l", l}, {"phi", phi}};
    const Eigen::MatrixXcd G = with_numbers(l, phi).transfer(kS, Precision::digits50);
    CHECK((system.update(values).transfer(kS) - G).norm() <= 1e-12 * G.norm());
    CHECK((system.update(values).state_space().transfer(kS) - G).norm() <= 1e-11 * G.norm());
    CHECK((f.at(values).transfer(kS) - G).norm() <= 1e-11 * G.norm());
  }
}

TEST_CASE("shapes: one parameter in a frequency and in scaled entries of the same mode") {
  Diagram d{"scene"};
  const Param p = d.param("p", 0.9);
  const FlexibleBody body(with_child(), {.omega = {{1, 2 * p}},
                                         .L_P = {{1, 5, 0.2 * p}},
                                         .Phi_C = {{"tip", {{1, 2, 0.8 * p}, {1, 5, -0.2 * p}}}}});
  const System system = compile(scene(body, std::move(d)));
  const Lft f = lft(system, {{"p", between(0.5, 1.2)}});
  for (const double value : {0.55, 0.8, 1.0, 1.19}) {
    ModalData data = with_child();
    data.omega(0) = 2 * value;
    data.L_P(0, 4) = 0.2 * value;
    data.children[0].Phi_C(1, 0) = 0.8 * value;
    data.children[0].Phi_C(4, 0) = -0.2 * value;
    const Eigen::MatrixXcd G =
        compile(scene(FlexibleBody{data}, Diagram{"scene"})).transfer(kS, Precision::digits50);
    CHECK((system.update({{"p", value}}).transfer(kS) - G).norm() <= 1e-12 * G.norm());
    CHECK((f.at({{"p", value}}).transfer(kS) - G).norm() <= 1e-11 * G.norm());
  }
}

TEST_CASE("shapes: derivatives equal differences of bodies of other data") {
  const Derivatives g = derivatives(with_parameters(), {"l", "phi"});
  const auto of = [](double l, double phi) {
    return with_numbers(l, phi).transfer(kS, Precision::digits50);
  };
  const auto central = [&](double l, double phi) {
    return Eigen::MatrixXcd((of(kL + l, kPhi + phi) - of(kL - l, kPhi - phi)) / (2 * (l + phi)));
  };
  constexpr double kStep = 1e-3;  // Richardson: error of the order of step^4
  const Eigen::MatrixXcd l = (4 * central(kStep / 2, 0) - central(kStep, 0)) / 3,
                         phi = (4 * central(0, kStep / 2) - central(0, kStep)) / 3;
  CHECK((g.transfer(kS, "l") - l).norm() <= 1e-9 * l.norm());
  CHECK((g.transfer(kS, "phi") - phi).norm() <= 1e-9 * phi.norm());
}

TEST_CASE("shapes: values of no entry, and modes with more mass than the body") {
  const FlexibleBody plain(with_child());
  const auto refused = [&](const ModeValues& values) {
    return error_of([&] {
      Diagram d{"d"};
      d.add("X", FlexibleBody{plain, values});
    });
  };
  CHECK(refused({.L_P = {{1, 1, 0.1}}}).mistakes().empty());
  CHECK(says(refused({.L_P = {{4, 1, 0.1}}}), Code::bad_modes, {"X", "mode 4", "3"}));
  CHECK(says(refused({.L_P = {{1, 7, 0.1}}}), Code::bad_modes, {"X", "component 7", "L_P"}));
  CHECK(says(refused({.L_P = {{1, 2, 0.1}, {1, 2, 0.2}}}), Code::bad_modes,
             {"X", "mode 1, component 2", "L_P"}));
  CHECK(says(refused({.Phi_C = {{"tip", {{1, 0, 0.1}}}}}), Code::bad_modes,
             {"X", "component 0", "Phi_C of tip"}));
  CHECK(
      says(refused({.Phi_C = {{"end", {{1, 1, 0.1}}}}}), Code::unknown_name, {"X", "end", "tip"}));
  CHECK(says(refused({.L_P = {{1, 1, HUGE_VAL}}}), Code::not_finite, {"X", "L_P", "inf"}));
  CHECK(says(error_of([] { with_parameters().update({{"l", 20.0}}); }), Code::bad_modes, {"boom"}));
}

TEST_CASE("shapes: values of a body with other values are kept where none replaces them") {
  const FlexibleBody body(
      with_values(0.1, 0.2),
      {.omega = {{2, 6.0}}, .L_P = {{1, 5, 0.3}, {2, 1, 0.4}}, .Phi_C = {{"tip", {{3, 6, 0.5}}}}});
  const ModalData data = body.nominal();
  CHECK(data.omega == Vector3d(2, 6, 9));
  CHECK(data.L_P(0, 4) == 0.3);
  CHECK(data.L_P(1, 0) == 0.4);
  CHECK(data.children[0].Phi_C(4, 0) == 0.2);
  CHECK(data.children[0].Phi_C(5, 2) == 0.5);
  CHECK(data.L_P(2, 2) == with_child().L_P(2, 2));
}
