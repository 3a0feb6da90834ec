#include <doctest/doctest.h>

#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/titop.hpp>

#include "oracle.hpp"

/// Blocks far below their own frequencies, where C (s - A)^-1 B + D is a small difference: finer
/// precisions compute blocks from their matrices, and are still accurate to their own digits.
/// Against 150 digits.

using namespace titop;
using namespace solve_test;

namespace {

constexpr Precision kFine[] = {Precision::refined, Precision::twofold, Precision::digits50};

double off(std::complex<double> found, const Complex& exact) {
  const Complex error = (Complex(found) - exact) / exact;
  return static_cast<double>(sqrt(error.squared()));
}

/// The acceleration under a force; and a loop by `gain`, which takes digits of double.
Diagram on_the_wall(const SpringMass& spec, double gain) {
  Diagram d{"low"};
  auto u = d.input("u");
  auto z = d.add("z", spec);
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, gain)});
  z.parent.accel = 0;
  z.child.force = u;
  L.in = u + L.out;
  d.output("a") = z.child.accel;
  d.output("g") = L.out;
  return d;
}

Diagram filter(const Lti& lti) {
  Diagram d{"filter"};
  auto K = d.add("K", lti);
  K.in = d.input("u");
  d.output("y") = K.out;
  return d;
}

}  // namespace

TEST_CASE("low: the acceleration on a stiff spring, far below its frequency, in every precision") {
  const double mass = 3, stiffness = 7e5;
  for (const double damping : {0.0, 2.0})
    for (const double gain : {0.0, 0.999, 0.99999}) {
      const System system =
          compile(on_the_wall({.mass = mass, .stiffness = stiffness, .damping = damping}, gain));
      for (const double omega : {1e2, 1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-12, 1e-20}) {
        const std::complex<double> s(0, omega);
        const Complex exact = spring_transfer(mass, stiffness, damping, 0, Complex(s))(0, 0);
        const auto error = [&](Precision p) { return off(system.transfer(s, p)(0, 0), exact); };
        CAPTURE(damping);
        CAPTURE(gain);
        CAPTURE(omega);
        CHECK(error(Precision::standard) <= 1e-15);
        CHECK(error(Precision::as_needed) <= 1e-15);
        for (const Precision p : kFine) {
          CAPTURE(static_cast<int>(p));
          CHECK(error(p) <= 1e-15);
        }
      }
    }
}

TEST_CASE("low: rounding does not excuse a difference") {
  const System system = compile(on_the_wall({.mass = 3, .stiffness = 7e5}, 0.5));
  for (const double omega : {1.0, 1e-3, 1e-6}) {
    const std::complex<double> s(0, omega);
    // The last place may differ; a thousandth of the terms is the allowed error.
    const double size = std::abs(system.transfer(s)(0, 0));
    CHECK(1e-3 * detail::terms(detail::data_of(system), {s})(0, 0) <= size);
  }
}

TEST_CASE("low: a high-pass given by its matrices; a notch at its frequency lets nothing through") {
  const auto one = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  const System high = compile(filter({.A = one(-0.7), .B = one(1), .C = one(-0.7), .D = one(1)}));
  for (const double omega : {1e-3, 1e-8, 1e-16, 1e-30}) {
    const std::complex<double> s(0, omega);
    const Complex exact = Complex(s) / (Complex(s) + Complex(0.7));
    for (const Precision p : kFine) CHECK(off(high.transfer(s, p)(0, 0), exact) <= 1e-15);
  }
  // (s^2 + 1) / (s^2 + 0.3 s + 1)
  const System notch = compile(filter({.A = Eigen::MatrixXd{{0, 1}, {-1, -0.3}},
                                       .B = Eigen::MatrixXd{{0}, {1}},
                                       .C = Eigen::MatrixXd{{0, -0.3}},
                                       .D = one(1)}));
  for (const Precision p : kFine) CHECK(std::abs(notch.transfer({0, 1}, p)(0, 0)) <= 1e-18);
}

TEST_CASE("low: masses and springs far apart cost 32 digits, too: right, finer, or refused") {
  for (const double r : {1e3, 1e6, 1e9, 1e12}) {
    Diagram d{"far_apart"};
    auto a = d.add("a", SpringMass{.mass = r, .stiffness = 1 / r, .parent_mass = 1});
    auto b = d.add("b", SpringMass{.mass = 1 / r, .stiffness = r});
    a.parent.force = -d.input("u");
    mount(b, a.child);
    d.output("x") = b.child.position;
    d.output("y") = a.child.accel;
    const System system = compile(d);
    for (const std::complex<double> s : {std::complex<double>(0.1, 1), {0, 1e4}}) {
      const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
      CAPTURE(r);
      CAPTURE(s);
      for (const Precision precision : {Precision::as_needed, Precision::twofold}) {
        try {
          const Eigen::MatrixXcd found = system.transfer(s, precision);
          CHECK(((found - exact).array().abs() / exact.array().abs()).maxCoeff() <= 1e-12);
        } catch (const Error& error) {
          CHECK(error.has(Code::singular));
          CHECK(precision == Precision::twofold);  // as_needed has 50 digits to go to
        }
      }
    }
  }
}

TEST_CASE("low: the static gain of supports inside a chain is the limit of the transfers") {
  // At s = 0 accelerations vanish: the 50-digit rounding of a block there is no pivot.
  const System system =
      compile(read_diagram(std::string(TITOP_SOURCE_DIR) + "/tests/corpus/scenes/064.json"));
  const Eigen::MatrixXd limit = system.transfer({1e-8, 0}, Precision::digits50).real();
  CHECK((system.static_gain() - limit).cwiseAbs().maxCoeff() <= 1e-7);
  CHECK(std::abs(limit(0, 0)) < 0.77);
  CHECK(std::abs(limit(0, 0)) > 0.76);
  for (const Precision p : {Precision::as_needed, Precision::digits50}) {
    CAPTURE(static_cast<int>(p));
    CHECK_THROWS_AS(system.transfer(0, p), Error);
  }
}
