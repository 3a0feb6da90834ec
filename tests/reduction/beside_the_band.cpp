#include <doctest/doctest.h>

#include "held.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// Poles outside the band: at 0, unreachable or unobservable, and modes far below. The reference is
/// written out by hand.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// A chain of masses on springs and dashpots from the wall, the force u on the last one.
struct Chain {
  int masses = 6;
  double m = 1, k = 1e3, c = 0.2;

  Diagram diagram(std::vector<SpringMass::Handle>& z) const {
    Diagram d{"chain"};
    auto u = d.input("u");
    for (int i = 0; i < masses; ++i) {
      z.push_back(
          d.add("z" + std::to_string(i + 1), SpringMass{.mass = m, .stiffness = k, .damping = c}));
      if (i == 0)
        z[0].parent.accel = 0;
      else
        mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
    }
    z.back().child.force += u;
    return d;
  }
  /// Force over position.
  MatrixXcd stiffness(Complex s) const {
    MatrixXcd S = MatrixXcd::Zero(masses, masses);
    const Complex link = k + s * c;
    for (int i = 0; i < masses; ++i) {
      S(i, i) = s * s * m + link * (i + 1 < masses ? 2.0 : 1.0);
      if (i > 0) S(i, i - 1) = S(i - 1, i) = -link;
    }
    return S;
  }
};

}  // namespace

TEST_CASE("two integrators of one position hide a pole at 0: no effect of it remains beside 0 Hz") {
  const double ki[] = {300, 120};
  const std::size_t act[] = {1, 4}, read = 3;
  for (const double c : {0.2, 0.0}) {
    CAPTURE(c);
    const Chain chain{.c = c};
    std::vector<SpringMass::Handle> z;
    Diagram d = chain.diagram(z);
    for (int q = 0; q < 2; ++q) {
      auto law = d.add("law" + std::to_string(q),
                       Lti{.A = one(0), .B = one(1), .C = one(ki[q]), .D = one(0.3 * ki[q])});
      law.in = -1.0 * z[read].child.position;
      z[act[q]].child.force += law.out;
    }
    d.output("x") = z.back().child.position;
    d.output("y") = z[1].child.position;
    const auto truth = [&](Complex s) {
      MatrixXcd S = chain.stiffness(s);
      for (int q = 0; q < 2; ++q)
        S(static_cast<Index>(act[q]), static_cast<Index>(read)) += ki[q] * (0.3 + 1.0 / s);
      MatrixXcd F = MatrixXcd::Zero(chain.masses, 1);
      F(chain.masses - 1) = 1;
      const MatrixXcd x = S.partialPivLu().solve(F);
      return MatrixXcd{{x(chain.masses - 1)}, {x(1)}};
    };
    for (const BoundKind kind : {BoundKind::estimate, BoundKind::theorem}) {
      const titop::Scene scene{.band_hz = {0, 8}, .accuracy = 1e-6, .bound = kind};
      const ReducedSystem r = compile(d, scene);
      CHECK(step(r, "kept").after == 2 * chain.masses + 1);
      CHECK(beside(r, scene, with_poles(r, truth)).bound <= 1);
      for (double hertz = 1e-22; hertz < 1e-3; hertz *= 10) {
        CAPTURE(hertz);
        const Complex s = 2 * M_PI * hertz * Complex(0.002, std::sqrt(1 - 4e-6));
        const MatrixXd off = (r.transfer(s) - truth(s)).cwiseAbs().cwiseQuotient(r.bound().peak);
        CHECK(off.maxCoeff() <= r.bound().worst);
      }
    }
  }
}

TEST_CASE("modes far below the band keep their high-frequency asymptote: a mass, no motion") {
  const Chain chain{.masses = 12, .k = 1e2, .c = 0};
  for (const bool slow : {false, true}) {
    CAPTURE(slow);
    Chain damped = chain;
    damped.c = slow ? 0.01 : 0;
    std::vector<SpringMass::Handle> z;
    Diagram d = damped.diagram(z);
    d.output("a") = z.back().child.accel;
    d.output("x") = z.back().child.position;
    const auto truth = [&](Complex s) {
      MatrixXcd F = MatrixXcd::Zero(chain.masses, 1);
      F(chain.masses - 1) = 1;
      const Complex x = damped.stiffness(s).partialPivLu().solve(F)(chain.masses - 1);
      return MatrixXcd{{s * s * x}, {x}};
    };
    // The acceleration alone is 1 / m to (2 k / m) / s^2 (and c / (m s)).
    for (const double accuracy : {1e-1, 1e-3, 1e-8}) {
      CAPTURE(accuracy);
      const titop::Scene scene{.outputs = {"a"}, .band_hz = {1000, 2000}, .accuracy = accuracy};
      const ReducedSystem r = compile(d, scene);
      const auto first = [&](Complex s) { return MatrixXcd(truth(s).topRows(1)); };
      const Beside fine = beside(r, scene, with_poles(r, first), 500);
      CHECK(fine.bound <= 1);
      CHECK(fine.error <= 1.01 * accuracy);
      if (accuracy > 1e-4) {
        CHECK(r.order() == 0);
        CHECK(std::abs(r.state_space().D(0, 0) - 1 / chain.m) <= 1e-9);
      }
    }
    int before = 0;
    for (const double accuracy : {1e-1, 1e-3, 1e-5}) {
      const titop::Scene scene{.band_hz = {3, 6}, .accuracy = accuracy};  // two modes inside
      const ReducedSystem r = compile(d, scene);
      CHECK(r.order() >= before);
      before = r.order();
      const Beside fine = beside(r, scene, with_poles(r, truth), 1000);
      CHECK(fine.bound <= 1);
      CHECK(fine.error <= 1.01 * accuracy);
    }
  }
}

TEST_CASE("a free body that its own rate brakes has no gain at 0: refused at any mass and gain") {
  Rng rng(7);
  for (int trial = 0; trial < 36; ++trial) {
    CAPTURE(trial);
    Diagram d{"braked"};
    auto u = d.input("u");
    auto body = d.add("body", RigidBody{.mass = rng.between(1, 100), .inertia = {5, 6, 7}});
    MatrixXd along = MatrixXd::Zero(6, 1);
    along(trial % 6) = 1;
    const MatrixXd back = along.transpose();
    body.parent.force =
        std::pow(10.0, rng.between(-3, 3)) * along * (back * body.parent.rate) - along * u;
    d.output("x") = back * body.parent.position;
    const titop::Scene scene{.band_hz = {0, rng.between(0.1, 10)}};
    CHECK(says(error_of([&] { compile(d, scene); }), Code::bad_value, {"x", "band_hz", "u"}));
  }
}
