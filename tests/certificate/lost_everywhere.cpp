#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/titop.hpp>

/// Rounding is accepted for a 0 among other entries, but no model that has lost digits everywhere.

using namespace titop;
using namespace titop::detail;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

TEST_CASE("terms of nothing: those of a 0 beside others, and where nothing stands") {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  MatrixXcd G(3, 2);
  G << 1e-17, 4, 9, 1, 0, 0;
  MatrixXd terms(3, 2);
  terms << 1, 1e12, 8e10, 1, 1, 0;
  const double millionth = 1e-6 / kEpsilon;  // of 1
  const MatrixXd left = of_nothing(terms, {G});
  CHECK(left(0, 0) == 1);
  CHECK(left(0, 1) == 0);  // rounding of 1e12 leaves no 6 digits of 4
  CHECK(left(1, 0) == 0);  // nor that of 8e10 of 9
  CHECK(left(1, 1) == 1);
  CHECK(left(2, 0) == 1);  // there is no other scale
  const MatrixXcd one = MatrixXcd::Constant(1, 1, 1);
  for (const double part : {0.5, 0.9, 1.1, 2.0})
    CHECK((of_nothing(MatrixXd::Constant(1, 1, part * millionth), {one})(0, 0) > 0) == (part < 1));
}

TEST_CASE("digits that the whole model has lost are not excused by its rounding") {
  // Feedback of an acceleration leaves 1e-12 of a mass of 2: some 4 digits.
  Diagram d{"nearly massless"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 5, .damping = 0.1});
  auto w = d.add("w", SpringMass{.mass = 1, .stiffness = 3, .damping = 0.2});
  ground(z);
  mount(w, z.child);
  z.child.force += (2 + 1e-12) * z.child.accel + d.input("u");
  d.output("x") = w.stretch + z.stretch;
  const System system = compile(d, {.minimize_up_to = 0});
  const FullCertificate c = certify(system);
  CAPTURE(to_string(c));
  double worst = 0;
  for (const Complex s : {Complex(0.05, 1), Complex(5, 100), Complex(5e3, 1e5)}) {
    const Complex exact = system.transfer(s, Precision::digits50)(0, 0);
    worst =
        std::max(worst, std::abs(system.state_space().transfer(s)(0, 0) - exact) / std::abs(exact));
  }
  CHECK(worst > 1e-6);
  CHECK(c.grid.dense >= 0.01 * worst);
  CHECK_FALSE(c.holds());
}
