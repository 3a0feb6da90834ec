#include <doctest/doctest.h>

#include <cmath>
#include <titop/compiler/certify_full.hpp>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// Poles that share their vectors, and equal poles beside them: what leaves, against exact
/// arithmetic.

using namespace titop;
using Eigen::MatrixXd;

namespace {

MatrixXd number(double x) { return MatrixXd::Constant(1, 1, x); }

Lti filter(double pole) {
  return {.A = number(pole), .B = number(1), .C = number(1), .D = number(0)};
}

/// With as many names as it has states, inputs and outputs.
StateSpace named(StateSpace m) {
  m.states.clear(), m.inputs.clear(), m.outputs.clear();
  for (Eigen::Index i = 0; i < m.A.rows(); ++i) m.states.push_back("x" + std::to_string(i));
  for (Eigen::Index i = 0; i < m.B.cols(); ++i) m.inputs.push_back("u" + std::to_string(i));
  for (Eigen::Index i = 0; i < m.C.rows(); ++i) m.outputs.push_back("y" + std::to_string(i));
  return m;
}

StateSpace model(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  return named({A, B, C, MatrixXd::Zero(C.rows(), B.cols()), {}, {}, {}});
}

/// A critically damped mass with two equal poles at -sqrt(k), a filter of the same pole, and an
/// undamped mass, all moved by one input. The filter and the block of two share their pole: the
/// input reaches 2 of these 3 states, 4 of all 5.
Diagram critical(double k, bool read) {
  Diagram d{"critical"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = k, .damping = 2 * std::sqrt(k)});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 3});
  auto q = d.add("q", filter(-std::sqrt(k)));
  ground(a), ground(b);
  a.child.force = u, b.child.force = u, q.in = u;
  if (read) {
    d.output("y") = 1.0 * a.stretch + q.out;
    d.output("z") = b.stretch;
  }
  return d;
}

/// A free mass, whose position one of two equal filters reads: 4 states, all of them needed.
Diagram free_mass(bool read) {
  Diagram d{"free mass"};
  auto u = d.input("u"), v = d.input("v");
  auto h = d.add("h", SpringMass{.mass = 2, .stiffness = 0});
  auto p = d.add("p", filter(-1.25)), q = d.add("q", filter(-1.25));
  ground(h);
  h.child.force = u, p.in = 1.0 * h.stretch, q.in = v;
  if (read) d.output("p") = p.out, d.output("q") = q.out;
  return d;
}

/// The exact order; without outputs, of what inputs reach, and without inputs, of what outputs see.
int exact(StateSpace m) {
  const Eigen::Index n = m.A.rows();
  const MatrixXd one = MatrixXd::Identity(n, n);
  if (m.C.rows() == 0) m = model(m.A, m.B, one);
  if (m.B.cols() == 0) m = model(m.A, one, m.C);
  const ExactOrder order = exact_order(m);
  REQUIRE(order.decided);
  return order.order;
}

void check(const StateSpace& m) {
  const int needed = exact(m);
  const Minimized r = minimize(m);
  CAPTURE(needed);
  CAPTURE(to_string(r.order));
  CHECK(r.order.lowest <= needed);
  CHECK(r.order.highest >= needed);
  CHECK(r.model.order() >= needed);
  CHECK(r.order.change <= 1e-8);
}

}  // namespace

TEST_CASE("critically damped beside a filter of the same pole: what is not judged stays") {
  for (const double k : {0.25, 1.0, 4.0, 16.0}) {
    CAPTURE(k);
    for (const bool read : {false, true}) {
      CAPTURE(read);
      const System system = compile(critical(k, read));
      CHECK(system.state_space().order() >= 4);
      CHECK(system.order_verdict().lowest <= 4);
      CHECK(system.order_verdict().highest >= 4);
      CHECK(system.poles().size() >= 3);
      CHECK(certify(system).faults.empty());
    }
    const System decided = compile(critical(k, true), {.exact_up_to = 10});
    CHECK(decided.state_space().order() >= 4);
    CHECK(decided.order_verdict().lowest == 4);
  }
}

TEST_CASE("equal filters beside a free mass: all 4 states are needed, and that is decided") {
  for (const bool read : {false, true}) {
    const System system = compile(free_mass(read));
    CHECK(system.state_space().order() == 4);
    CHECK(system.order_verdict().decided());
    CHECK(certify(system).faults.empty());
  }
}

TEST_CASE("an input that does not touch a cluster is no direction of it: 7 of 9 states") {
  Diagram d{"appendages"};
  auto u = d.input("u"), w = d.input("w");
  const SpringMass mass{.mass = 1, .stiffness = 4, .damping = 0.25};
  auto z0 = d.add("z0", mass), z1 = d.add("z1", mass), z2 = d.add("z2", mass),
       z4 = d.add("z4", mass);
  auto c = d.add("c", filter(-2));
  ground(z0), ground(z1);
  mount(z2, z1.child), mount(z4, z1.child);
  c.in = u;
  z1.child.force += 0.5 * c.out;
  z2.child.force = u, z4.child.force = w, z0.child.force = w;
  d.output("y1") = z1.child.rate;
  d.output("y2") = z0.child.rate;
  REQUIRE(exact_order(d.graph()).order == 7);
  const System system = compile(d);
  CHECK(system.state_space().order() == 7);
  CHECK(system.order_verdict().decided());
  CHECK(certify(system).faults.empty());
}

TEST_CASE("two equal filters on one signal, in any units of inputs: one is enough") {
  for (const double unit : {1.0, 0x1p30, 0x1p-30}) {
    CAPTURE(unit);
    MatrixXd A = MatrixXd::Zero(4, 4), B = MatrixXd::Zero(4, 2), C = MatrixXd::Zero(2, 4);
    A.topLeftCorner(2, 2) << 0, 1, -3, -0.25;
    A.bottomRightCorner(2, 2).diagonal() << -1.25, -1.25;
    A(2, 0) = A(3, 0) = 1;
    B(1, 0) = unit, B(2, 1) = B(3, 1) = 0.5;
    C << 1, 0, 1, 2, 0, 0, 3, 1;
    const StateSpace m = model(A, B, C);
    REQUIRE(exact(m) == 3);
    const Minimized r = minimize(m);
    CHECK(r.model.order() == 3);
    CHECK(r.order.decided());
    CHECK(r.order.change <= 1e-12);
  }
}

TEST_CASE("vectors of real poles stay real: what leaves changes nothing") {
  MatrixXd A(6, 6), B(6, 1), C(1, 6);
  A << -3, -1, -2, 1, -2, -1, 1, -2, 1, 0, 1, 0, 0, 1, -2, -1, 0, 0,  //
      1, -1, 1, -1, 1, 0, 0, 0, 1, 0, -1, 1, 0, 0, -1, 0, -1, -1;
  B << -1, 1, 2, -1, -2, 0;
  C << 0, 1, 1, -1, 1, -1;
  const StateSpace m = model(A, B, C);
  REQUIRE(exact(m) == 3);
  const Minimized r = minimize(m);
  CHECK(r.model.order() == 3);
  CHECK(r.order.decided());
  CHECK(r.order.change <= 1e-12);
}

TEST_CASE("without outputs all states count, also beside an integrator that does not take them") {
  MatrixXd A = MatrixXd::Zero(2, 2);
  A(0, 0) = -2;
  const StateSpace m = model(A, MatrixXd::Ones(2, 1), MatrixXd(0, 2));
  REQUIRE(exact(m) == 2);
  CHECK(minimize(m).model.order() == 2);
}

TEST_CASE("random Jordan blocks in whole numbers: the verdict holds what exact arithmetic finds") {
  titop_test::Rng rng(4);
  const auto whole = [&] { return static_cast<double>(rng.below(5) - 2); };
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    // Up to four blocks of -3, ..., 0, each of 1 to 3 equal poles, some of them twice.
    std::vector<std::pair<double, int>> blocks;
    for (int k = 2 + rng.below(3); k > 0; --k) {
      blocks.emplace_back(-rng.below(4), rng.below(3) ? 1 : 1 + rng.below(3));
      if (rng.below(2)) blocks.push_back(blocks.back());
    }
    int n = 0;
    for (const auto& block : blocks) n += block.second;
    MatrixXd A = MatrixXd::Zero(n, n);
    int row = 0;
    for (const auto& [pole, size] : blocks)
      for (int i = 0; i < size; ++i, ++row) {
        A(row, row) = pole;
        if (i > 0) A(row - 1, row) = 1;
      }
    MatrixXd B(n, 1 + rng.below(2)), C(1 + rng.below(2), n);
    for (double& x : B.reshaped()) x = whole();
    for (double& x : C.reshaped()) x = whole();
    for (int k = 0; k < n; ++k) {  // other coordinates, without rounding
      const int i = rng.below(n), j = rng.below(n);
      if (i == j) continue;
      A.row(i) += A.row(j), B.row(i) += B.row(j);
      A.col(j) -= A.col(i), C.col(j) -= C.col(i);
    }
    check(model(A, B, C));
    check(model(A, B, MatrixXd(0, n)));
    check(model(A, MatrixXd(n, 0), C));
  }
}

TEST_CASE("a model whose names or matrices do not fit is refused") {
  MatrixXd A = MatrixXd::Zero(2, 2);
  A(0, 1) = 1;
  const StateSpace fits = model(A, MatrixXd::Ones(2, 1), MatrixXd::Ones(1, 2));
  CHECK(minimize(fits).model.order() == 2);
  const auto refused = [](const StateSpace& m, const char* text) {
    try {
      minimize(m);
      FAIL("it is taken");
    } catch (const Error& error) {
      CHECK(error.has(Code::size));
      CHECK(std::string(error.what()).find(text) != std::string::npos);
    }
  };
  StateSpace m = fits;
  m.states.clear();
  refused(m, "A of the model is 2 x 2, by its names it is 0 x 0");
  m = fits, m.inputs.clear();
  refused(m, "B of the model is 2 x 1, by its names it is 2 x 0");
  m = fits, m.outputs.clear();
  refused(m, "C of the model is 1 x 2, by its names it is 0 x 2");
  m = fits, m.D = MatrixXd::Zero(1, 3);
  refused(m, "D of the model is 1 x 3, by its names it is 1 x 1");
}
