#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "solve/oracle.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// A parent mass from 1 down to nothing in every form of the spring-mass block, against 50 digits:
/// right, or refused by name; never infinite, never an unreported loss.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using solve_test::BigMatrix;
using solve_test::Complex;

namespace {

struct Numbers {
  double m = 1, k = 3, c = 0.02, m0 = 1;
};

/// Imposed side of the child and of the parent.
struct Form {
  bool child_accel, parent_force;
};

/// Outputs: at the child and, unless left out, at the parent the signals that are not imposed.
Diagram scene(const Numbers& n, Form form, bool parent_read) {
  Diagram d{"form"};
  auto at_C = d.input("c"), at_P = d.input("p");
  auto z =
      d.add("z", SpringMass{.mass = n.m, .stiffness = n.k, .damping = n.c, .parent_mass = n.m0});
  if (form.child_accel)
    z.child.accel = at_C;
  else
    z.child.force = at_C;
  if (form.parent_force)
    z.parent.force = at_P;
  else
    z.parent.accel = at_P;
  if (form.child_accel)
    d.output("C") = z.child.force;
  else
    d.output("C") = z.child.accel;
  if (!parent_read) return d;
  if (form.parent_force)
    d.output("P") = z.parent.accel;
  else
    d.output("P") = z.parent.force;
  return d;
}

/// The same from (3): m x_C'' = f_C - g dx, f_P = g dx - m0 x_P'', g = k + c s, dx = x_C - x_P.
MatrixXcd exact(const Numbers& n, Form form, std::complex<double> at) {
  const Complex s(at), s2 = s * s, g = Complex(n.k) + Complex(n.c) * s;
  // Unknowns x_C'', f_C, x_P'', f_P.
  BigMatrix E(4, 4), F(4, 2);
  E(0, 0) = Complex(n.m) + g / s2, E(0, 1) = Complex(-1), E(0, 2) = Complex(0) - g / s2;
  E(1, 0) = Complex(0) - g / s2, E(1, 2) = g / s2 + Complex(n.m0), E(1, 3) = Complex(1);
  E(2, form.child_accel ? 0 : 1) = Complex(1), F(2, 0) = Complex(1);
  E(3, form.parent_force ? 3 : 2) = Complex(1), F(3, 1) = Complex(1);
  const MatrixXcd all = solve_test::rounded(solve_test::solve(E, F));
  MatrixXcd y(2, 2);
  y.row(0) = all.row(form.child_accel ? 1 : 0);
  y.row(1) = all.row(form.parent_force ? 2 : 3);
  return y;
}

/// Worst entry, each over itself over all points (0 if both are).
double error(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& b) {
  double worst = 0;
  for (Eigen::Index i = 0; i < a[0].rows(); ++i)
    for (Eigen::Index j = 0; j < a[0].cols(); ++j) {
      double off = 0, size = 0;
      for (std::size_t k = 0; k < a.size(); ++k) {
        if (!a[k].allFinite()) return HUGE_VAL;
        off = std::max(off, std::abs(a[k](i, j) - b[k](i, j)));
        size = std::max(size, std::abs(b[k](i, j)));
      }
      if (off > 0) worst = std::max(worst, off / size);
    }
  return worst;
}

const std::vector<std::complex<double>> kPoints = {{0.05, 0.3}, {0.2, 1.9}, {1, 14}};
constexpr Form kForms[] = {{false, false}, {true, false}, {false, true}, {true, true}};

/// The transfer is right to 1e-12; the dense model, which may have lost digits, is finite.
void check(const Numbers& n, Form form, bool parent_read) {
  const System system = compile(scene(n, form, parent_read), {.minimize_up_to = 0});
  std::vector<MatrixXcd> a, right;
  for (const auto s : kPoints) {
    a.push_back(system.transfer(s));
    right.push_back(exact(n, form, s).topRows(parent_read ? 2 : 1));
  }
  CHECK(error(a, right) <= 1e-12);
  const StateSpace& m = system.state_space();
  CHECK((m.A.allFinite() && m.B.allFinite() && m.C.allFinite() && m.D.allFinite()));
}

/// Error of the dense model: by its certificate, and measured at that s.
struct Loss {
  double stated, found;
};

Loss loss(const Numbers& n, Form form) {
  const System system = compile(scene(n, form, true), {.minimize_up_to = 0});
  const StateSpace& dense = system.state_space();
  const Certificate c = system.dense_certificate();
  const std::complex<double> s = c.dense_error_where_small_s;
  if (s == 0.0) return {0, 0};
  return {c.dense_error_where_small, error({dense.transfer(s)}, {exact(n, form, s)})};
}

}  // namespace

TEST_CASE("parent mass from 1 through 1e-300 to 0, in all four forms") {
  for (const Form form : kForms)
    for (const double m0 :
         {1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-30, 1e-100, 1e-200, 1e-300, 0.0}) {
      CAPTURE(form.child_accel);
      CAPTURE(form.parent_force);
      CAPTURE(m0);
      const Numbers n{.m0 = m0};
      if (form.parent_force && m0 == 0) {  // the end's acceleration would need a derivative
        const Error e = compile_error(scene(n, form, true));
        CHECK(needs_derivatives(e, "p", "P", 1));
        CHECK(says(e, Code::improper, {"z", "SpringMass{.parent_mass = ...}"}));
        check(n, form, false);
        continue;
      }
      check(n, form, true);
    }
}

TEST_CASE("mass ratios of 1e-12 and 1e12, and errors of units") {
  for (const Form form : kForms)
    for (const double unit : {1.0, 1e-9, 1e9})
      for (const double ratio : {1e-12, 1e12}) {
        CAPTURE(form.child_accel);
        CAPTURE(form.parent_force);
        CAPTURE(unit);
        CAPTURE(ratio);
        check({.m = unit, .k = 3 * unit, .c = 0.02 * unit, .m0 = ratio * unit}, form, true);
      }
}

TEST_CASE("the error of the dense model is stated, at all masses, damped or not") {
  int all = 0, far = 0;
  for (const Form form : kForms)
    for (const double c : {0.0, 0.02})
      for (const double k : {3.0, 3e-9, 3e9})
        for (const double m : {1.0, 1e-12, 1e12})
          for (const double m0 : {1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-30, 1e-60, 1e12}) {
            CAPTURE(form.child_accel);
            CAPTURE(form.parent_force);
            CAPTURE(c);
            CAPTURE(k);
            CAPTURE(m);
            CAPTURE(m0);
            const auto [stated, found] = loss({.m = m, .k = k, .c = c, .m0 = m0}, form);
            CAPTURE(stated);
            CAPTURE(found);
            CHECK(std::min(found, 1.0) <= std::max(1e-12, 3 * stated));  // 1: no digit
            // Less close from above: the estimate is of first order, more than 1 if no digit is
            // left, and errors that round to 0 by chance in `found` need not do so in it.
            ++all, far += std::min(stated, 1.0) > std::max(1e-12, 60 * found);
          }
  CHECK(far * 10 <= all);
}

TEST_CASE("of a force on hardly any mass the dense model's answer at the mass behind is right") {
  for (const double m0 : {1e-20, 1e-40, 1e-60, 1e-100, 1e-200, 1e-300}) {
    CAPTURE(m0);
    const Numbers n{.m0 = m0};
    const Form form{.child_accel = false, .parent_force = true};
    const System system = compile(scene(n, form, false), {.minimize_up_to = 0});
    const StateSpace& dense = system.state_space();
    for (const auto s : kPoints)
      CHECK(error({dense.transfer(s)}, {exact(n, form, s).topRows(1)}) <= 1e-15);
    CHECK(system.dense_certificate().dense_error <= 1e-9);  // above it the log would warn
  }
}
