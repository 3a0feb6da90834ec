#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>
#include <vector>

#include "support/mistakes.hpp"

/// Coordinates of a model and their rates: as the blocks declare them, through every step.

using namespace titop;
using Eigen::MatrixXd;

namespace {

using Names = std::vector<std::string>;

/// A mass on a spring, with a controller that reads the stretch: an own time constant, no
/// coordinate.
Diagram controlled() {
  Diagram d{"controlled"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  auto k = d.add("K", Lti{.A = MatrixXd{{-3.0}}, .B = MatrixXd{{1.0}}, .C = MatrixXd{{1.0}}});
  z.parent.accel = 0;
  k.in = z.stretch;
  z.child.force = d.input("u") - k.out;
  d.output("y") = z.stretch;
  return d;
}

/// Two masses on springs that are welded: a closed chain, in which one stretch is the other.
Diagram welded() {
  Diagram d{"welded"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 3, .stiffness = 5});
  a.parent.accel = 0;
  b.parent.accel = 0;
  b.child.accel = a.child.accel;
  a.child.force = d.input("u") - b.child.force;
  d.output("y") = a.stretch;
  return d;
}

/// By hand: q' = v, v' = -4 q.
StateSpace oscillator() {
  return {MatrixXd{{0, 1}, {-4, 0}},
          MatrixXd{{0.0}, {1.0}},
          MatrixXd{{1, 0}},
          MatrixXd{{0.0}},
          {"m.q", "m.v"},
          {"u"},
          {"y"},
          {}};
}

}  // namespace

TEST_CASE("rates: a controller in the loop leaves those of the mechanics known") {
  const StateSpace m = compile(controlled()).state_space();
  CHECK(m.states == Names{"z.stretch", "z.stretch_rate", "K.x1"});
  CHECK(m.rates == Names{"z.stretch_rate", "", ""});
  CHECK(rates_of(m) == std::vector<int>{1, -1, -1});
  CHECK(!second_order(m).found);  // the controller's state is neither
}

TEST_CASE("rates: in a closed chain, of the states that are left") {
  const StateSpace m = compile(welded()).state_space();
  REQUIRE(m.order() == 2);
  CHECK(m.rates == Names{m.states[1], ""});
  const SecondOrder form = second_order(m);
  REQUIRE(form.found);
  CHECK(std::abs(form.S(0, 0) / ((4.0 + 5.0) / (1.0 + 3.0)) - 1) <= 1e-14);
}

TEST_CASE("rates: positions of a free body are integrals of integrals") {
  Diagram d{"free"};
  auto hub = d.add("hub", RigidBody{.mass = 2});
  hub.parent.force = -d.input("u", 6);
  d.output("x", 6) = hub.parent.position;
  const StateSpace m = compile(d).state_space();
  REQUIRE(m.order() == 12);
  int coordinates = 0;
  for (std::size_t i = 0; i < m.rates.size(); ++i)
    if (!m.rates[i].empty()) {
      ++coordinates;
      MatrixXd row = MatrixXd::Zero(1, 12);
      row(m.state(m.rates[i])) = 1;
      CHECK(m.A.row(static_cast<Eigen::Index>(i)) == row);
    }
  CHECK(coordinates == 6);
}

TEST_CASE("rates: minimal realization leaves the names of the states that it keeps") {
  Diagram d{"beside"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
  auto idle = d.add("idle", SpringMass{.mass = 1, .stiffness = 5});
  for (auto* each : {&z, &idle}) each->parent.accel = 0;
  z.child.force = d.input("u");
  idle.child.force = 0.0 * z.stretch;
  d.output("y") = z.stretch;
  const StateSpace m = minimize(compile(d, {.minimize_up_to = 0}).state_space()).model;
  CHECK(m.states == Names{"z.stretch", "z.stretch_rate"});
  CHECK(m.rates == Names{"z.stretch_rate", ""});
}

TEST_CASE(
    "rates: of a model by hand, by its rows; a name that its row contradicts does not count") {
  StateSpace m = oscillator();
  CHECK(rates_of(m) == std::vector<int>{1, -1});
  m.rates = {"m.v", ""};
  CHECK(rates_of(m) == std::vector<int>{1, -1});
  CHECK(poles(m).front().s == std::complex<double>(0, 2));
  m.rates = {"", ""};
  CHECK(rates_of(m) == std::vector<int>{-1, -1});
  m.rates = {"m.v", ""};
  m.A(0, 0) = 0.5;
  CHECK(rates_of(m) == std::vector<int>{-1, -1});
  CHECK(!second_order(m).found);
  m.rates = {"m.v"};  // not known which
  CHECK(poles(m).size() == 1);
  CHECK(titop_test::says(titop_test::error_of([&] { minimize(m); }), Code::size,
                         {"rates", "1 x 1", "2 x 1"}));
}

TEST_CASE("rates: the rate of two coordinates makes no second-order form") {
  StateSpace m = oscillator();
  m.A = MatrixXd{{0, 0, 1, 0}, {0, 0, 1, 0}, {-4, 0, 0, 0}, {0, -4, 0, 0}};
  m.states = {"a.q", "b.q", "a.v", "b.v"};
  CHECK(rates_of(m) == std::vector<int>{2, 2, -1, -1});
  CHECK(!second_order(m).found);
}
