#include <doctest/doctest.h>

#include <titop/analysis/certify/certify_full.hpp>
#include <titop/titop.hpp>

/// Outputs that are 0 to the last bit on one way of computing and rounding on another: no fault.

using namespace titop;
using Eigen::MatrixXd;

TEST_CASE("certificate: an output that nothing moves is 0 by all equations") {
  Diagram d{"at rest"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 4, .stiffness = 12});
  auto b = d.add("b", SpringMass{.mass = 4, .stiffness = 16, .damping = 16});
  ground(a);
  ground(b);
  b.child.force = u;
  d.output("y") = 1.0 * b.child.accel + 1.0 * a.child.rate;
  d.output("z") = 1.0 * a.child.position + 1.0 * a.child.position;
  const FullCertificate c = certify(compile(d), {});
  CHECK(c.faults.empty());
  CHECK(c.grid.written >= 0);
  CHECK(c.grid.written <= 1e-12);
}

TEST_CASE("certificate: a direct path that is 0 in the factors and rounding in the dense model") {
  for (const double gain : {-1e9, 1e6, 1e9}) {
    CAPTURE(gain);
    Diagram d{"stiff feedback"};
    auto u = d.input("u");
    auto hub = d.add("hub", SpringMass{.mass = 2, .stiffness = 4});
    auto p = d.add("p", SpringMass{.mass = 1, .stiffness = 3});
    auto r = d.add("r", SpringMass{.mass = 1, .stiffness = 3});
    auto q = d.add("q", Lti{.A = MatrixXd{{-1.0}},
                            .B = MatrixXd{{1.0}},
                            .C = MatrixXd{{1.0}},
                            .D = MatrixXd{{0.0}}});
    ground(hub);
    mount(p, hub.child);
    mount(r, hub.child);
    q.in = hub.child.position;
    hub.child.force += gain * q.out + u;
    d.output("position") = hub.child.position;
    d.output("q") = q.out;
    const FullCertificate c = certify(compile(d), {});
    CHECK(c.faults.empty());
    CHECK(c.basic.dense_against_factors >= 0);
    CHECK(c.basic.dense_against_factors <= 1e-9);
  }
}
