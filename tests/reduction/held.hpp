#pragma once

#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>

#include "against.hpp"

/// A structure with a controller in its loop, the reference by hand, and the requirements on a
/// reduced system with balanced states.
namespace titop_test {

inline Eigen::MatrixXd one(double x) { return Eigen::MatrixXd::Constant(1, 1, x); }

/// gain / (s / corner + 1)
inline titop::Lti lag(double gain, double corner) {
  return {.A = one(-corner), .B = one(1), .C = one(gain * corner)};
}

/// A free cart with a chain of equal masses on springs, kept at its place by a law with a slow
/// actuator and a delay: (kp + kd s) / (s / wa + 1) (1 - sT/2) / (1 + sT/2).
struct Held {
  int masses = 12;
  double cart = 10, m = 0.5, k = 2000, c = 1.5;
  double kp = 15, kd = 20, wa = 30, T = 0.03;

  titop::Diagram diagram() const {
    titop::Diagram d{"held"};
    auto U = d.input("U");
    auto R = d.input("R");  // where it should be
    std::vector<titop::SpringMass::Handle> z;
    for (int i = 0; i < masses; ++i) {
      titop::SpringMass spec{.mass = m, .stiffness = k, .damping = c};
      if (i == 0) spec.parent_mass = cart;
      z.push_back(d.add("z" + std::to_string(i + 1), spec));
      if (i > 0) mount(z[at(i)], z[at(i - 1)].child);
    }
    auto law = d.add(
        "law",
        titop::Lti{.A = one(-wa), .B = one(1), .C = one((kp - kd * wa) * wa), .D = one(kd * wa)});
    auto delay =
        d.add("delay", titop::Lti{.A = one(-2 / T), .B = one(1), .C = one(4 / T), .D = one(-1)});
    law.in = R - z[0].parent.position;
    delay.in = law.out;
    z[0].parent.force = -(U + delay.out);
    d.output("x") = z[0].parent.position;
    d.output("a") = z.back().child.accel;
    d.output("F") = delay.out;
    return d;
  }
  /// [x; a; F] from [U; R], by the dynamic stiffness of the chain seen from the cart.
  Eigen::MatrixXcd transfer(std::complex<double> s) const {
    std::complex<double> seen = 0,
                         ratio = 1;  // force per position of the last mass so far; tip per cart
    for (int i = 0; i < masses; ++i) {
      const std::complex<double> mass = seen + s * s * m, spring = k + s * c;
      ratio *= spring / (mass + spring);
      seen = mass * spring / (mass + spring);
    }
    const std::complex<double> C =
        (kp + kd * s) / (s / wa + 1.0) * (1.0 - s * T / 2.0) / (1.0 + s * T / 2.0);
    const std::complex<double> own = seen + s * s * cart, closed = own + C;
    Eigen::MatrixXcd H(3, 2);
    H << 1.0 / closed, C / closed, s * s * ratio / closed, s * s * ratio * C / closed, -C / closed,
        C * own / closed;
    return H;
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

/// A reference with the full system's poles, for a finer grid there.
inline Truth with_poles(const titop::ReducedSystem& r,
                        std::function<Eigen::MatrixXcd(std::complex<double>)> transfer) {
  Truth truth{std::move(transfer), {}};
  for (const titop::Pole& p : r.full().poles()) truth.omegas.push_back(p.omega);
  return truth;
}

inline Beside beside_by_hand(const titop::ReducedSystem& r, const titop::Scene& scene,
                             const Held& held) {
  return beside(r, scene, with_poles(r, [&](std::complex<double> s) { return held.transfer(s); }));
}

inline const titop::ReductionStep& step(const titop::ReducedSystem& r, const std::string& name) {
  for (const titop::ReductionStep& s : r.steps())
    if (s.name == name) return s;
  FAIL("no step " << name);
  return r.steps().front();
}

inline double rightmost(const titop::StateSpace& m) {
  return m.A.size() ? m.A.eigenvalues().real().maxCoeff() : -HUGE_VAL;
}

}  // namespace titop_test
