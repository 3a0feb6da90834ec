#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/random_scene.hpp"

/// What writing the dense model down costs: said beforehand, found when it is tried.

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
              FlexibleBody(titop_test::scaled(titop_test::random_modes(rng, 6, {"C"}, true),
                                              {.mass = i % 2 ? ratio : 1}))));
  body.front().parent.force = -U;
  for (std::size_t i = 1; i < body.size(); ++i)
    mount(body[i], body[i - 1].child, Rotation::matrix(rng.rotation()));
  d.output("tip", 6) = body.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// The error of the dense model for all inputs, at the s where the certificate says it is largest.
double tried(const System& system) {
  const std::complex<double> s = system.certificate().dense_error_s;
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
  return (system.state_space().transfer(s) - exact).cwiseAbs().maxCoeff() /
         exact.cwiseAbs().maxCoeff();
}

bool warns(const System& system) {
  return system.log().find("the model keeps") != std::string::npos;
}

}  // namespace

TEST_CASE("dense export: harmless where the bodies are alike") {
  const System system = chain(1);
  system.state_space();
  CHECK(system.certificate().dense_error >= 0);
  CHECK(system.certificate().dense_error <= 1e-11);
  CHECK(system.certificate().dense_against_factors <= 1e-13);
  CHECK(!warns(system));
}

TEST_CASE("dense export: what it costs at mass ratios is said, and so it is") {
  for (const double ratio : {1e6, 1e9, 1e12}) {
    const System system = chain(ratio);
    CHECK(system.certificate().dense_error < 0);
    system.state_space();
    const double said = system.certificate().dense_error, found = tried(system);
    MESSAGE(fmt::format("ratio {:.0e}: said {:.1e}, found {:.1e}", ratio, said, found));
    CAPTURE(ratio);
    // The dense solution that `tried` needs has rounding of its own, of the same size.
    CHECK(found <= 100 * said);
    CHECK(said <= 100 * found);
    CHECK(warns(system) == (said > 1e-9));
  }
}

TEST_CASE("dense export: what write() made is judged as what state_space() made, without it") {
  for (const double ratio : {1.0, 1e9}) {
    const System system = chain(ratio);
    StateSpace written;
    system.write(written);
    const Certificate of_written = system.certificate(written);
    CHECK(system.certificate().dense_error < 0);  // none of its own yet
    system.state_space();
    const Certificate own = system.certificate();
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

TEST_CASE("dense export: an output that is small where slow modes are warns of its digits") {
  // A stiff mass (10^4 rad/s) that carries a soft one (1 rad/s): far below both the acceleration of
  // the first is s^2 / k1 times the force, what is left of 1/m1 - 1/m1.
  Diagram d{"stiff and soft"};
  auto u = d.input("u");
  auto stiff = d.add("stiff", SpringMass{.mass = 1.0, .stiffness = 1e8});
  auto soft = d.add("soft", SpringMass{.mass = 1.0, .stiffness = 1.0});
  ground(stiff);
  mount(soft, stiff.child);
  stiff.child.force += u;
  d.output("a") = stiff.child.accel;
  const System system = compile(d, {.minimize_up_to = 0});
  system.state_space();
  const Certificate c = system.certificate();
  CHECK(c.dense_error <= 1e-12);
  const std::complex<double> s = c.dense_error_where_small_s;
  const auto exact = system.transfer(s, Precision::digits50);
  CHECK(std::abs(exact(0, 0) * 1e8 / (s * s) - 1.0) <= 1e-2);  // k1: the soft mass hardly counts
  const double off = (system.state_space().transfer(s) - exact).norm() / exact.norm();
  CHECK(off <= 100 * c.dense_error_where_small);
  CHECK(c.dense_error_where_small >= 1e-6);
  CHECK(system.log().find("where outputs are small, A, B, C, D keep") != std::string::npos);
  CHECK(!warns(system));
}
