#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

/// Poles whose vectors are no basis: what is not judged stays.

using namespace titop;
using Eigen::MatrixXd;

TEST_CASE("minimal: critical damping beside a filter of the same pole, with outputs and without") {
  for (const double k : {0.25, 1.0, 4.0, 16.0})
    for (const bool seen : {false, true}) {
      CAPTURE(k);
      CAPTURE(seen);
      Diagram d{"critical"};
      auto u = d.input("u");
      auto a = d.add("a", SpringMass{.mass = 1, .stiffness = k, .damping = 2 * std::sqrt(k)});
      auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 3});
      auto f = d.add("f", Lti{.A = MatrixXd{{-std::sqrt(k)}},
                              .B = MatrixXd{{1.0}},
                              .C = MatrixXd{{1.0}},
                              .D = MatrixXd{{0.0}}});
      ground(a);
      ground(b);
      a.child.force = u;
      b.child.force = u;
      f.in = u;
      if (seen) d.output("y") = 1.0 * a.stretch + 1.0 * b.stretch + f.out;
      // The filter adds nothing to the double pole that u moves: 2 + 2 states.
      const System s = compile(d);
      CHECK(s.state_space().order() >= 4);
      CHECK(s.order_verdict().lowest <= 4);
      CHECK(s.order_verdict().highest >= 4);
    }
}
