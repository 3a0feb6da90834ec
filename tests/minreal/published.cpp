#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/names.hpp"
#include "support/transfer_error.hpp"

/// Hard cases for minimal order from public bug reports, as they are built from blocks.

using namespace titop;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// gain / (s + pole) with the pole at -a.
Lti lag(double a, double gain) {
  return {.A = MatrixXd{{-a}}, .B = MatrixXd{{1}}, .C = MatrixXd{{gain}}};
}

/// P = [W1, -W1 G; 0, W2; 0, W3 G; 1, -G], with a block wherever a function is written.
Diagram weights() {
  Diagram d{"weights"};
  auto w = d.input("w"), u = d.input("u");
  const Lti G = lag(1.5, 0.5), W1 = lag(1.2, 0.8), W2 = lag(1.125, 0.875),
            W3 = lag(12. / 11, 10. / 11);
  auto W1a = d.add("W1a", W1), W1b = d.add("W1b", W1), W2a = d.add("W2", W2), W3a = d.add("W3", W3);
  auto G1 = d.add("G1", G), G2 = d.add("G2", G), G3 = d.add("G3", G);
  W1a.in = w;
  G1.in = u, W1b.in = G1.out;
  W2a.in = u;
  G2.in = u, W3a.in = G2.out;
  G3.in = u;
  d.output("z1") = W1a.out - W1b.out;
  d.output("z2") = W2a.out;
  d.output("z3") = W3a.out;
  d.output("y") = w - G3.out;
  return d;
}

/// [g/s; g; s g; ...; s^(k-1) g] with g = 1/(s - 1)^k, each output from a block of its own.
Diagram powers(int k) {
  std::vector<double> p(static_cast<std::size_t>(k) + 1, 0);  // (s - 1)^k
  p[0] = 1;
  for (int i = 0; i < k; ++i)
    for (int j = i + 1; j >= 0; --j)
      p[static_cast<std::size_t>(j)] =
          (j > 0 ? p[static_cast<std::size_t>(j) - 1] : 0) - p[static_cast<std::size_t>(j)];
  MatrixXd A = MatrixXd::Zero(k, k);
  A.topRightCorner(k - 1, k - 1).setIdentity();
  for (int j = 0; j < k; ++j) A(k - 1, j) = -p[static_cast<std::size_t>(j)];
  Diagram d{"powers"};
  auto u = d.input("u");
  MatrixXd A1 = MatrixXd::Zero(k + 1, k + 1);
  A1.topLeftCorner(k, k) = A;
  A1(k, 0) = 1;
  auto first = d.add(
      "b0",
      Lti{.A = A1, .B = VectorXd::Unit(k + 1, k - 1), .C = VectorXd::Unit(k + 1, k).transpose()});
  first.in = u;
  d.output("y0") = first.out;
  for (int i = 1; i <= k; ++i) {
    auto b = d.add(
        "b" + std::to_string(i),
        Lti{.A = A, .B = VectorXd::Unit(k, k - 1), .C = VectorXd::Unit(k, i - 1).transpose()});
    b.in = u;
    d.output("y" + std::to_string(i)) = b.out;
  }
  return d;
}

}  // namespace

TEST_CASE("four weights around one plant: order 4 of 7, in double and exactly") {
  const System system = compile(weights());
  CHECK(system.order() == 7);
  CHECK(system.state_space().order() == 4);
  StateSpace full;
  system.write(full);
  const Minimized r = minimize(full);
  CHECK(r.order.decided());
  CHECK(r.order.lowest == 4);
  CHECK(exact_order(system.stage().graph).order == 4);
  CHECK(exact_order(weights().graph()).order == 4);
  for (const std::complex<double> s : {std::complex<double>{0.1, 1}, {2, 5}, {0, 0}})
    CHECK(titop_test::transfer_error<Eigen::MatrixXcd>({system.state_space().transfer(s)},
                                                       {transfer(weights().graph(), s)},
                                                       {1, 1, 1, 1}, {1, 1}) <= 1e-14);
}

TEST_CASE("a pole of order k many times over: k + 1 exactly; in double an interval, and why") {
  for (int k = 1; k <= 10; ++k) {
    CAPTURE(k);
    const Diagram d = powers(k);
    const ExactOrder exact = exact_order(d.graph(), {.states = 120});
    CHECK(exact.decided);
    CHECK(exact.order == k + 1);
    CHECK(exact.states == k * k + k + 1);
    const System system = compile(d, {.minimize_up_to = 0}), counted = compile(d),
                 asked = compile(d, {.exact_up_to = k * k + k + 1});
    CHECK(asked.state_space().order() <= counted.state_space().order());
    CHECK(asked.order_verdict().lowest == k + 1);
    const Minimized r = minimize(system.state_space());
    CHECK(r.order.lowest <= k + 1);
    CHECK(r.order.highest >= k + 1);
    if (k <= 4) CHECK((r.order.decided() && r.model.order() == k + 1));
    if (k <= 4) continue;
    CHECK(!r.order.decided());
    CHECK(titop_test::has_names(to_string(r.order), {fmt::format("{}", r.order.lowest),
                                                     fmt::format("{}", r.order.highest)}));
  }
}
