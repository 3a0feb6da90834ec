#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <titop/titop.hpp>

#include "generate/diagrams/modes.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// Rounding error of the dense model: predicted, and measured.

using namespace titop;
using titop_test::Rng;

namespace {

/// Ten flexible bodies, every second one `ratio` times heavier.
System chain(double ratio) {
  Rng rng(3);
  Diagram d{"chain"};
  const auto U = d.input("U", 6);
  std::vector<BodyHandle> body;
  for (int i = 0; i < 10; ++i)
    body.push_back(
        d.add(fmt::format("b{}", i + 1),
              FlexibleBody(titop::scaled(titop::generate::random_modes(rng, 6, {"C"}, true),
                                         {.mass = i % 2 ? ratio : 1}))));
  body.front().parent.force = -U;
  for (std::size_t i = 1; i < body.size(); ++i)
    mount(body[i], body[i - 1].child, Rotation::matrix(rng.rotation()));
  d.output("tip", 6) = body.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// The error of the dense model for all inputs, at the certificate's s of the largest error.
double tried(const System& system) {
  const std::complex<double> s = system.dense_certificate().dense_error_s;
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
  return (system.state_space().transfer(s) - exact).cwiseAbs().maxCoeff() /
         exact.cwiseAbs().maxCoeff();
}

/// True if the log warns of digits lost by A, B, C, D at this s, with these names.
bool warns(const System& system, std::complex<double> s,
           std::initializer_list<std::string_view> names = {}) {
  return std::ranges::any_of(system.dense_notes(), [&](const Note& n) {
    return n.kind == Note::Kind::warning && n.pass == "dense" &&
           titop_test::has_names(n.text, {"A, B, C, D", "System::transfer", titop_test::at_s(s)}) &&
           titop_test::has_names(n.text, names);
  });
}

/// The same at any s.
bool warns_of(const System& system, std::initializer_list<std::string_view> names) {
  return titop_test::noted(system, Note::Kind::warning, "dense", names);
}

/// Of digits of the largest outputs.
bool warns(const System& system, std::initializer_list<std::string_view> names = {}) {
  return warns(system, system.dense_certificate().dense_error_s, names);
}

}  // namespace

TEST_CASE("dense export: harmless where the bodies are alike") {
  const System system = chain(1);
  system.state_space();
  CHECK(system.dense_certificate().dense_error >= 0);
  CHECK(system.dense_certificate().dense_error <= 1e-11);
  CHECK(system.dense_certificate().dense_against_factors <= 1e-13);
  CHECK(!warns(system));
}

TEST_CASE("dense export: its error at mass ratios is reported, and is that error") {
  for (const double ratio : {1e6, 1e9, 1e12}) {
    const System system = chain(ratio);
    CHECK(system.certificate().dense_error < 0);
    const double said = system.dense_certificate().dense_error, found = tried(system);
    MESSAGE(fmt::format("ratio {:.0e}: said {:.1e}, found {:.1e}", ratio, said, found));
    CAPTURE(ratio);
    // The dense solution that `tried` needs has rounding of its own, of the same size.
    CHECK(found <= 100 * said);
    CHECK(said <= 100 * found);
    CHECK(warns(system) == (said > 1e-9));
    CHECK(warns(system) == warns(system, {"tip(", "U("}));
  }
}

TEST_CASE("dense export: write() gets the verdict of state_space(), without calling it") {
  for (const double ratio : {1.0, 1e9}) {
    const System system = chain(ratio);
    StateSpace written;
    system.write(written);
    const Certificate of_written = system.certificate(written);
    const Certificate own = system.dense_certificate();
    CHECK(system.certificate().dense_error < 0);  // of the factors alone
    CHECK(of_written.dense_error == own.dense_error);
    CHECK(of_written.dense_error_where_small == own.dense_error_where_small);
    CHECK(of_written.dense_against_factors == own.dense_against_factors);
    CHECK(of_written.residual == own.residual);
    // A wrong entry is found.
    written.A(written.order() - 1, 0) += 1e-3 * written.A.cwiseAbs().maxCoeff();
    CHECK(system.certificate(written).dense_against_factors >= 1e-5);
  }
  CHECK(titop_test::says(titop_test::error_of([] {
                           StateSpace model;
                           chain(1).write(model);
                           model.states.pop_back();
                           (void)chain(1).certificate(model);
                         }),
                         Code::size, {"119 states", "chain", "System::write", "120 states"}));
}

TEST_CASE("dense export: write() fills the caller's buffer again, whatever stands there") {
  const System system = chain(1);
  StateSpace model;
  system.write(model);
  const StateSpace first = model;
  const std::vector<const double*> before = {model.A.data(), model.B.data(), model.C.data(),
                                             model.D.data()};
  for (Eigen::MatrixXd* m : {&model.A, &model.B, &model.C, &model.D})
    m->setConstant(std::numeric_limits<double>::quiet_NaN());
  system.write(model);
  CHECK(std::vector<const double*>{model.A.data(), model.B.data(), model.C.data(),
                                   model.D.data()} == before);
  CHECK((model.A == first.A && model.B == first.B && model.C == first.C && model.D == first.D));
}

namespace {

/// A stiff mass that carries a soft one (1 rad/s): far below both the acceleration of the first is
/// s^2 / stiffness times the force, the difference of terms 1/m1 - 1/m1.
System stiff_and_soft(double stiffness) {
  Diagram d{"stiff and soft"};
  auto u = d.input("u");
  auto stiff = d.add("stiff", SpringMass{.mass = 1.0, .stiffness = stiffness});
  auto soft = d.add("soft", SpringMass{.mass = 1.0, .stiffness = 1.0});
  ground(stiff);
  mount(soft, stiff.child);
  stiff.child.force += u;
  d.output("acc") = stiff.child.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// Error of A, B, C, D at s, relative to the largest output there.
double off_at(const System& system, std::complex<double> s) {
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
  return (system.state_space().transfer(s) - exact).norm() / exact.norm();
}

}  // namespace

TEST_CASE("dense export: an output that is small where slow modes are warns of its digits") {
  const System system = stiff_and_soft(1e12);
  const Certificate c = system.dense_certificate();
  CHECK(c.dense_error <= 1e-12);
  const std::complex<double> s = c.dense_error_where_small_s;
  const auto exact = system.transfer(s, Precision::digits50);
  CHECK(std::abs(exact(0, 0) * 1e12 / (s * s) - 1.0) <= 1e-2);  // the soft mass hardly counts
  CHECK(off_at(system, s) <= 100 * c.dense_error_where_small);
  CHECK(off_at(system, {0.1, 1}) >= 1e-6);  // beside the soft mode
  CHECK(c.dense_error_where_small >= 1e-6);
  CHECK(warns_of(system, {"acc", "u"}));
  CHECK(!warns(system));
}

TEST_CASE("dense export: digits lost only below all poles are in the certificate, not in the log") {
  const System system = stiff_and_soft(1e8);
  const Certificate c = system.dense_certificate();
  const std::complex<double> s = c.dense_error_where_small_s;
  CHECK(std::abs(s) < 0.1);
  CHECK(off_at(system, s) >= 1e-6);
  CHECK(off_at(system, s) <= 100 * c.dense_error_where_small);
  for (const double w : {0.5, 1.0, 1e2, 1e4}) CHECK(off_at(system, {0.1 * w, w}) <= 1e-7);
  CHECK(titop_test::count_notes(system, Note::Kind::warning, "dense", {}) == 0);
  // A beam on a pin with a rotary spring: accelerations of a grounded tip.
  for (const double k : {1.0, 1e2, 1e4, 1e8}) {
    CAPTURE(k);
    Diagram d{"pin"};
    const auto F = d.input("F", 6);
    auto frame = d.add("frame", RigidBody{.mass = 1, .children = {{"c"}}});
    auto beam = d.add("beam", FlexibleBody{Beam{.length = 3,
                                                .section = {1e-3, 1e-8, 1e-8, 2e-8},
                                                .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                                .elements = 6}});
    ground(frame);
    const auto pin = hinge(d, "pin", beam, frame.child("c"), {}, {0, 0, 1});
    pin.torque = k * pin.angle;
    beam.child("C").force += F;
    d.output("a", 6) = beam.child("C").accel;
    CHECK(titop_test::count_notes(compile(d), Note::Kind::warning, "dense", {}) == 0);
  }
}

TEST_CASE("dense export: digits lost of the largest output do not hide those of a small one") {
  // Side by side: bodies of very different masses, and the stiff mass that carries a soft one.
  Diagram d{"both"};
  const auto u = d.input("u"), v = d.input("v");
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 10; ++i) {
    z.push_back(
        d.add(fmt::format("z{}", i + 1),
              SpringMass{.mass = i % 2 ? 1e9 : 1.0, .stiffness = 100.0 + i, .parent_mass = 0.5}));
    i == 0 ? ground(z[0]) : mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
  }
  auto stiff = d.add("stiff", SpringMass{.mass = 1.0, .stiffness = 1e12});
  auto soft = d.add("soft", SpringMass{.mass = 1.0, .stiffness = 1.0});
  ground(stiff);
  mount(soft, stiff.child);
  z[4].child.force += u;
  stiff.child.force += v;
  d.output("last") = z.back().child.accel;
  d.output("acc") = stiff.child.accel;
  const System system = compile(d, {.minimize_up_to = 0});
  system.state_space();
  const Certificate c = system.dense_certificate();
  CHECK(c.dense_error >= 1e-9);
  CHECK(c.dense_error_where_small >= 1e-6);
  CHECK(c.dense_error_where_small >= 10 * c.dense_error);
  CHECK(warns(system, {"last", "u"}));
  CHECK(warns_of(system, {"acc", "v"}));
}

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInfinite = std::numeric_limits<double>::infinity();

/// One mass on a spring, pushed by `push` N per unit of u and read by a gain that is a parameter.
System reading(double push = 1) {
  Diagram d{"reading"};
  const Param out = d.param("out", 2.0);
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 3.0, .stiffness = 10.0});
  ground(z);
  z.child.force += push * u;
  d.output("x") = out * z.stretch;
  d.output("a") = out * z.child.accel;
  return compile(d, {.minimize_up_to = 0});
}

StateSpace written(const System& system) {
  StateSpace model;
  system.write(model);
  return model;
}

/// The certificate's verdict on the model after `change`.
template <class F>
double difference(const System& system, F change) {
  StateSpace model = written(system);
  change(model);
  return system.certificate(model).dense_against_factors;
}

}  // namespace

TEST_CASE("dense export: a model of other numbers differs from the factors, whichever they are") {
  using Matrix = Eigen::MatrixXd StateSpace::*;
  for (const double push : {1.0, 1e-12, 1e12}) {  // units of u: its effect on x is no scale
    CAPTURE(push);
    const System system = reading(push);
    CHECK(difference(system, [](StateSpace&) {}) <= 1e-15);
    for (const Matrix m : {&StateSpace::A, &StateSpace::B, &StateSpace::C, &StateSpace::D}) {
      // The last entries: none is 0.
      CHECK(difference(system, [&](StateSpace& model) {
              (model.*m)((model.*m).rows() - 1, 0) *= 1.001;
            }) >= 1e-4);
      CHECK(difference(system, [&](StateSpace& model) { model.*m *= 1000; }) >= 0.5);
      CHECK(difference(system, [&](StateSpace& model) { (model.*m).setZero(); }) >= 0.5);
    }
  }
}

TEST_CASE("dense export: a model of another update differs from the factors") {
  const System system = reading();
  const StateSpace other = written(system.update({{"out", 5.0}}));
  CHECK(system.certificate(other).dense_against_factors >= 0.5);  // 5 for 2: by 3 of 5
  CHECK(system.update({{"out", 5.0}}).certificate(other).dense_against_factors <= 1e-15);
}

TEST_CASE("dense export: of a diagram without states D is compared") {
  Diagram d{"gain"};
  auto u = d.input("u");
  auto g = d.add("g", Gain{.gain = 3});
  g.in = u;
  d.output("y") = g.out;
  const System system = compile(d);
  CHECK(difference(system, [](StateSpace&) {}) <= 1e-15);
  CHECK(difference(system, [](StateSpace& m) { m.D(0, 0) = 3.1; }) >= 0.01);
}

TEST_CASE("dense export: an output that is 0 by symmetry makes no difference of its rounding") {
  Rng rng(5);
  for (int round = 0; round < 20; ++round) {
    Diagram d{"across"};
    auto u = d.input("u");
    auto B = d.add("B", RigidBody{.mass = 3.7});
    const Vector3d along = rng.rotation() * Vector3d::UnitX();
    Eigen::MatrixXd push = Eigen::MatrixXd::Zero(6, 1), read = Eigen::MatrixXd::Zero(1, 6);
    push.topRows(3) = along;
    read.leftCols(3) = along.cross(rng.rotation() * Vector3d::UnitY()).transpose();
    B.parent.force = Eigen::MatrixXd(-push) * u;
    d.output("across") = read * B.parent.accel;
    d.output("along") = Eigen::MatrixXd(push.transpose()) * B.parent.accel;
    const System system = compile(d);
    CHECK(difference(system, [](StateSpace&) {}) <= 1e-15);
    CHECK(difference(system, [](StateSpace& m) { m.D(1, 0) *= 1.001; }) >= 1e-4);
  }
}

TEST_CASE("dense export: a model of another system is refused by name") {
  const System system = reading();
  const auto refused = [&](auto change) {
    StateSpace model = written(system);
    change(model);
    return titop_test::error_of([&] { (void)system.certificate(model); });
  };
  using titop_test::says;
  CHECK(says(refused([](StateSpace& m) { m.A.resize(0, 0); }), Code::size,
             {"A", "0 x 0", "2 x 2", "System::write"}));
  CHECK(says(refused([](StateSpace& m) { m.A = Eigen::MatrixXd::Zero(3, 3); }), Code::size,
             {"A", "3 x 3", "2 x 2"}));
  CHECK(says(refused([](StateSpace& m) { m.B = Eigen::MatrixXd::Zero(2, 2); }), Code::size,
             {"B", "2 x 2", "2 x 1"}));
  const Error both = refused([](StateSpace& m) { m.C.transposeInPlace(), m.D.resize(0, 1); });
  CHECK(both.mistakes().size() == 1);  // C is 2 x 2
  CHECK(says(both, Code::size, {"D", "0 x 1", "2 x 1"}));
  CHECK(refused([](StateSpace& m) { m.C.resize(1, 2), m.D.resize(1, 1); }).mistakes().size() == 2);
  CHECK(says(refused([](StateSpace& m) { m.states[1] = "w"; }), Code::size,
             {"state 2", "w", "z.", "System::write"}));
  CHECK(says(refused([](StateSpace& m) { m.inputs[0] = "w"; }), Code::size, {"input 1", "w", "u"}));
  CHECK(says(refused([](StateSpace& m) { std::swap(m.outputs[0], m.outputs[1]); }), Code::size,
             {"output 1", "a", "x"}));
  CHECK(says(refused([](StateSpace& m) { m.A(0, 1) = kInfinite; }), Code::not_finite,
             {"A", "inf", "1e308"}));
  const Error nan = refused([](StateSpace& m) { m.C.setConstant(kNan), m.D(1, 0) = kNan; });
  CHECK(nan.mistakes().size() == 2);
  CHECK(says(nan, Code::not_finite, {"C", "nan", "x, z."}));
  CHECK(says(nan, Code::not_finite, {"D", "nan", "a, u", "System::write"}));
}

TEST_CASE("dense export: errors below the slow modes of a row of stiff bodies are stated") {
  // No body has a mode below 80 rad/s by itself; ten of them in a row bend at 0.5 rad/s, six
  // decades below the fastest of their modes.
  Diagram d{"row"};
  const auto F = d.input("F", 6);
  const FlexibleBody beam = Beam{.length = 2.0,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 8,
                                 .modes = {.kept = 20, .xi = {0.005}}};
  std::vector<FlexibleBody::Handle> b;
  for (int i = 0; i < 10; ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), beam));
    i == 0 ? ground(b[0]) : mount(b.back(), b[static_cast<std::size_t>(i) - 1].child);
  }
  b.back().child.force += F;
  d.output("a", 6) = b.back().child.accel;
  const System system = compile(d, {.minimize_up_to = 0});
  const StateSpace& model = system.state_space();
  const Certificate c = system.dense_certificate();
  const std::complex<double> s = c.dense_error_where_small_s;
  CHECK(std::abs(s) < 1);  // at its slow modes, or below them
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
  const double off = (model.transfer(s) - exact).norm() / exact.norm();
  CHECK(off >= 1e-6);
  CHECK(off <= 100 * c.dense_error_where_small);
  CHECK(off_at(system, {0.05, 0.5}) <= 1e-6);  // at the slowest mode
  CHECK(titop_test::count_notes(system, Note::Kind::warning, "dense", {}) == 0);
}
