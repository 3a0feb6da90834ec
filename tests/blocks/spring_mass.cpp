#include <doctest/doctest.h>

#include <cmath>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/invert.hpp>

#include "matrices.hpp"
#include "support/rng.hpp"

/// SpringMass against [Alazard 2015] eqs (3) to (7), as transcribed, and its inverses.

using namespace titop;
using namespace blocks_test;

namespace {

struct Values {
  double m, k, m0;
};
const Values kValues[] = {{2, 5, 0.75}, {0.3, 700, 11}, {1e3, 1e-2, 4}};

SpringMass spec(const Values& v) { return {.mass = v.m, .stiffness = v.k, .parent_mass = v.m0}; }
StateSpace model(const Values& v) { return channels_only(model_of(spec(v)), 2); }
StateSpace inverse(const StateSpace& m, const std::vector<int>& channels) {
  std::vector<std::pair<int, int>> pairs;
  for (const int c : channels) pairs.emplace_back(c, c);
  return invert(m, pairs);
}

}  // namespace

TEST_CASE("SpringMass: (3) without and (5) with a parent mass") {
  for (const auto& [m, k, m0] : kValues) {
    const MatrixXd A = matrix(2, 2, {0, 1, -k / m, 0}), B = matrix(2, 2, {0, 0, 1 / m, -1});
    const MatrixXd C = matrix(2, 2, {-k / m, 0, k, 0});
    CHECK(off(model({m, k, 0}), A, B, C, matrix(2, 2, {1 / m, 0, 0, 0})) == 0);
    CHECK(off(model({m, k, m0}), A, B, C, matrix(2, 2, {1 / m, 0, 0, -m0})) == 0);
  }
}

TEST_CASE("SpringMass: (4) and (6) as transfers, by the model and by the block") {
  for (const auto& [m, k, m0] : kValues)
    for (const Complex s : {Complex(0.3, 2), Complex(0, 0.1), Complex(1, 40)}) {
      const double wf2 = k * (m0 + m) / (m0 * m), wcp2 = k / m;
      MatrixXcd Z(2, 2);
      Z << s * s, k, k, -m * m0 * (s * s + wf2);
      Z /= m * (s * s + wcp2);
      CHECK(off(model({m, k, m0}).transfer(s), Z) <= 1e-12);
      const auto r = as_block(spec({m, k, m0}))->response(s, {});
      CHECK(off(r.Y.topRows(2), Z) <= 1e-14);
      CHECK(off(r.Y.row(2), r.X.row(0)) == 0);  // the stretch is the first state
      MatrixXcd Z0(2, 2);
      Z0 << s * s, k, k, -m * k;
      Z0 /= m * s * s + k;
      CHECK(off(as_block(spec({m, k, 0}))->response(s, {}).Y.topRows(2), Z0) <= 1e-14);
    }
}

TEST_CASE("SpringMass: response with damping solves the block's own equations") {
  titop_test::Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    const SpringMass z{.mass = rng.octaves(-3, 3),
                       .stiffness = rng.octaves(-3, 9),
                       .damping = rng.octaves(-5, 3),
                       .parent_mass = rng.between(0, 2)};
    const auto block = as_block(z);
    const auto d = block->dynamics({});
    const double omega = rng.octaves(-2, 6), sigma = rng.between(0.1, 1);
    const Complex s(sigma, omega);
    const auto r = block->response(s, {});
    const MatrixXcd states = s * r.X - d->A * r.X - d->B;
    CHECK(states.cwiseAbs().maxCoeff() <=
          1e-14 * (std::abs(s) * r.X.cwiseAbs() + d->A.cwiseAbs() * r.X.cwiseAbs()).maxCoeff());
    const MatrixXcd outputs = d->C * r.X + d->D - r.Y;
    CHECK(outputs.cwiseAbs().maxCoeff() <=
          1e-14 * (d->C.cwiseAbs() * r.X.cwiseAbs() + d->D.cwiseAbs()).maxCoeff());
  }
}

TEST_CASE("SpringMass: the three inverses as printed, to 1e-14") {
  for (const auto& [m, k, m0] : kValues) {
    const double wf2 = k * (m0 + m) / (m0 * m);
    const StateSpace Z = model({m, k, m0});
    CHECK(off(inverse(Z, {0, 1}), matrix(2, 2, {0, 1, -k / m0, 0}), matrix(2, 2, {0, 0, 1, 1 / m0}),
              matrix(2, 2, {k, 0, k / m0, 0}), matrix(2, 2, {m, 0, 0, -1 / m0})) <= 1e-14);
    CHECK(off(inverse(Z, {0}), matrix(2, 2, {0, 1, 0, 0}), matrix(2, 2, {0, 0, 1, -1}),
              matrix(2, 2, {k, 0, k, 0}), matrix(2, 2, {m, 0, 0, -m0})) <= 1e-14);
    CHECK(off(inverse(Z, {1}), matrix(2, 2, {0, 1, -wf2, 0}), matrix(2, 2, {0, 0, 1 / m, 1 / m0}),
              matrix(2, 2, {-k / m, 0, k / m0, 0}), matrix(2, 2, {1 / m, 0, 0, -1 / m0})) <= 1e-14);
  }
}

TEST_CASE("SpringMass: the paper's three properties, to 1e-14") {
  const MatrixXd J = matrix(2, 2, {0, -1, 1, 0});
  for (const auto& [m, k, m0] : kValues) {
    const StateSpace Z = model({m, k, m0});
    const StateSpace full = inverse(Z, {0, 1}), upper = inverse(Z, {0}), lower = inverse(Z, {1});
    // Against the entries on the way as well: k / m0 - k / m0 is 0 to the digits of k / m0.
    const auto differ = [&](const StateSpace& a, const StateSpace& b) {
      double worst = 0;
      for (const auto part : {&StateSpace::A, &StateSpace::B, &StateSpace::C, &StateSpace::D}) {
        double size = 0;
        for (const StateSpace* on_the_way : {&Z, &full, &upper, &lower})
          size = std::max(size, (on_the_way->*part).cwiseAbs().maxCoeff());
        worst = std::max(worst, (a.*part - b.*part).cwiseAbs().maxCoeff() / size);
      }
      return worst;
    };
    CHECK(differ(inverse(lower, {0, 1}), upper) <= 1e-14);
    CHECK(differ(inverse(full, {1}), upper) <= 1e-14);
    CHECK(differ(inverse(upper, {0, 1}), lower) <= 1e-14);
    CHECK(differ(inverse(full, {0}), lower) <= 1e-14);
    CHECK(differ(inverse(inverse(Z, {0}), {0}), Z) <= 1e-14);
    const StateSpace swapped = model({m0, k, m});
    for (const Complex s : {Complex(0.3, 2), Complex(1, 40)})
      CHECK(off(MatrixXcd(J * full.transfer(s) * J), swapped.transfer(s)) <= 1e-12);
  }
}

TEST_CASE("SpringMass: forced on both sides, G(s)") {
  for (const auto& [m, k, m0] : kValues) {
    const StateSpace free = inverse(model({m, k, m0}), {1});
    const double wf2 = k * (m0 + m) / (m0 * m), wcp2 = k / m, wcc2 = k / m0;
    const Complex s(0.2, 3);
    MatrixXcd G(2, 2);
    G << m0 * (s * s + wcc2), m * wcp2, m0 * wcc2, m * (s * s + wcp2);
    G /= m * m0 * (s * s + wf2);
    MatrixXcd ours = free.transfer(s);
    ours.col(1) *= -1;  // u2 = -f
    CHECK(off(ours, G) <= 1e-12);
  }
}

TEST_CASE("SpringMass: port-Hamiltonian form (7) and its energy balance") {
  titop_test::Rng rng(7);
  for (const auto& [m, k, m0] : kValues) {
    const double c = 0.3;
    const SpringMass z{.mass = m, .stiffness = k, .damping = c, .parent_mass = m0};
    const PortHamiltonian h = port_hamiltonian(z);
    CHECK(off(h.J, -h.J.transpose()) == 0);
    CHECK(off(h.state_space().transfer({0.4, 2}),
              as_block(z)->response({0.4, 2}, {}).Y.topRows(2)) <= 1e-12);
    for (int i = 0; i < 10; ++i) {
      const VectorXd x = rng.matrix(2, 1), u = rng.matrix(2, 1);
      CHECK(std::abs(h.energy(x) - (x(1) * x(1) / (2 * m) + k * x(0) * x(0) / 2)) <=
            1e-14 * h.energy(x));
      // dH/dt by the equations of motion: q' = p/m, p' = -k q - c p/m + f - m xdd.
      const double rate = x(1) / m, force = -k * x(0) - c * rate + u(0) - m * u(1);
      const double power = k * x(0) * rate + x(1) / m * force;
      const double terms = std::abs(k * x(0) * rate) + std::abs(rate * force);
      CHECK(std::abs(h.supplied(x, u) - h.dissipated(x) - power) <= 1e-13 * terms);
      CHECK(h.dissipated(x) >= 0);
    }
  }
}

TEST_CASE("SpringMass: no force on a massless end, and no negative numbers") {
  const auto code_of = [](auto make) {
    try {
      make();
    } catch (const Error& e) {
      return std::string(to_string(e.mistakes().front().code));
    }
    return std::string("none");
  };
  CHECK(code_of([] { invert(SpringMass{.mass = 1}, {"parent"}); }) == "improper");
  CHECK(code_of([] { as_block(SpringMass{.mass = -1}); }) == "bad-inertia");
  CHECK(code_of([] { as_block(SpringMass{.mass = 0}); }) == "bad-inertia");
  CHECK(code_of([] { as_block(SpringMass{.parent_mass = -1}); }) == "bad-inertia");
  CHECK(code_of([] { as_block(SpringMass{.stiffness = -1}); }) == "bad-value");
  CHECK(code_of([] { as_block(SpringMass{.damping = -1}); }) == "bad-value");
  CHECK(code_of([] { as_block(SpringMass{.mass = std::nan("")}); }) == "not-finite");
  CHECK(code_of([] { invert(SpringMass{}, {"tip"}); }) == "unknown-name");
}
