#include <doctest/doctest.h>

#include <limits>
#include <titop/analysis/reduction/coordinates.hpp>
#include <titop/analysis/reduction/whole.hpp>
#include <titop/compiler/system/compile_graph.hpp>

#include "scenes.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Limits of precision and forms that do not exist: refused with a reason.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

/// Masses m_i on springs k_i and dampers c_i, one on the other, the first clamped or free; force on
/// the last and its acceleration.
struct Chain {
  std::vector<double> m, k, c;
  Diagram diagram() const {
    Diagram d{"chain"};
    auto U = d.input("U");
    std::vector<SpringMass::Handle> z;
    for (std::size_t i = 0; i < m.size(); ++i) {
      z.push_back(d.add("z" + std::to_string(i + 1),
                        SpringMass{.mass = m[i], .stiffness = k[i], .damping = c[i]}));
      if (i == 0)
        z[0].parent.accel = 0;
      else
        mount(z[i], z[i - 1].child);
    }
    z.back().child.force = U;
    d.output("a") = z.back().child.accel;
    return d;
  }
  /// s^2 x_n / U by hand: from the last mass to the first, U = s^2 m x + (k + s c) (x - x_before).
  Complex accel(Complex s) const {
    // x_i = t_i x_(i-1) + r_i U, eliminated from the clamp on: stiffness seen below mass i.
    Complex below = k[0] + s * c[0];
    for (std::size_t i = 0; i + 1 < m.size(); ++i) {
      const Complex at_mass = below + s * s * m[i], spring = k[i + 1] + s * c[i + 1];
      below = at_mass * spring / (at_mass + spring);
    }
    return s * s / (below + s * s * m.back());
  }
};

}  // namespace

TEST_CASE("modes that rounding hides beside the first ones are static: nothing is not a number") {
  // Springs 1e24 times as stiff as the first: 1 / lambda of the high modes is rounding, of any
  // sign.
  const Chain chain{{2, 3, 1, 4, 2}, {30, 3e25, 7e25, 5e24, 9e25}, {0, 0, 0, 0, 0}};
  const titop::Scene scene{.band_hz = {0.01, 20}, .accuracy = 1e-6};
  for (const BoundKind kind : {BoundKind::estimate, BoundKind::theorem}) {
    titop::Scene asked = scene;
    asked.bound = kind;
    const ReducedSystem r = compile(chain.diagram(), asked);
    CHECK(r.order() == 2);
    CHECK(r.bound().worst <= 1e-6);
    for (const double w : {0.1, 1.0, 50.0})
      CHECK(relative(r.transfer({0.01 * w, w})(0, 0), chain.accel({0.01 * w, w})) <= 1e-6);
  }
}

TEST_CASE("a theorem counts the true poles of modes that damping couples") {
  const Chain chain{{2, 3, 1, 4}, {300, 500, 900, 4000}, {20, 0.1, 0, 3}};
  const titop::Scene scene{.band_hz = {0, 2}, .accuracy = 1e-2, .bound = BoundKind::theorem};
  const ReducedSystem r = compile(chain.diagram(), scene);
  CHECK(r.bound().kind == BoundKind::theorem);
  const auto by_hand = [&](Complex s) { return MatrixXcd::Constant(1, 1, chain.accel(s)); };
  check_beside(r, scene, {by_hand, {}}, 4000);
}

TEST_CASE("the poles of coupled modes are those of the dense model") {
  const Chain chain{{2, 3, 1, 4}, {300, 500, 900, 4000}, {20, 0.1, 0, 3}};
  const System system = compile(chain.diagram());
  const auto data = detail::compile_graph(chain.diagram().graph(), {});
  detail::Whole w = detail::whole(system, detail::coordinates(system, *data),
                                  detail::positions_read(chain.diagram().graph()));
  CHECK(!w.proportional);
  detail::couple(w);
  REQUIRE(w.poles.size() >= 4);
  for (const Pole& p : system.poles()) {
    double nearest = HUGE_VAL;
    for (const Complex& q : w.poles)
      nearest = std::min({nearest, relative(q, p.s), relative(std::conj(q), p.s)});
    CHECK(nearest <= 1e-9);
  }
}

TEST_CASE("modal form: motions without stiffness beside coupled damping are blocks of their own") {
  // A free hub with two dashpots on springs: its rate is a pole at 0, twice with the position.
  Diagram d{"free"};
  auto U = d.input("U");
  auto cart = d.add("cart", SpringMass{.mass = 2, .stiffness = 50, .damping = 3, .parent_mass = 4});
  auto mass = d.add("mass", SpringMass{.mass = 1, .stiffness = 90, .damping = 0.2});
  cart.parent.force = -U;
  mount(mass, cart.child);
  d.output("x") = cart.parent.position;
  const ReducedSystem r = compile(d, titop::Scene{.band_hz = {0.2, 20}, .accuracy = 1e-6});
  const SecondOrderModel second = r.second_order();
  REQUIRE(second.K.rows() == 3);
  CHECK(second.D(1, 2) != 0);
  for (const Complex s : {Complex(0.01, 0.3), Complex(0.2, 9), Complex(3, 0.5)})
    CHECK(matrix_error(r.modal().transfer(s), second.transfer(s)) <= 1e-9);
}

TEST_CASE("modal form: coupled modes with equal poles have none; the error names the way out") {
  // A tuned mass damper at the point where its two pairs of poles meet, with one eigenvector: mu =
  // 1, frequency 1 / (1 + mu), damping ratio sqrt(mu / (1 + mu)) [Krenk 2005, J. Appl. Mech. 72].
  const Chain chain{{1, 1}, {1, 0.25}, {0, std::sqrt(0.5)}};
  const titop::Scene scene{.band_hz = {0, 3}, .accuracy = 1e-6};
  const ReducedSystem r = compile(chain.diagram(), scene);
  const SecondOrderModel m = r.second_order();
  REQUIRE(m.K.rows() == 2);
  CHECK(relative(m.transfer({0.1, 2})(0, 0), chain.accel({0.1, 2})) <= 1e-9);
  CHECK(says(error_of([&] { r.modal(); }), Code::singular, {"2 x 2", "second_order()"}));
  const std::vector<double> accuracies{1e-6};
  CHECK(what_if(chain.diagram(), scene, accuracies).size() == 1);
}

TEST_CASE("what_if refuses accuracies out of range, all together, and omits those below rounding") {
  const Diagram d = frame(slim_beam(4));
  const titop::Scene scene{.band_hz = {0, 60}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> wrong{1e-2, 0, nan, 2};
  const Error error = error_of([&] { what_if(d, scene, wrong); });
  CHECK(error.mistakes().size() == 3);
  CHECK(says(error, Code::bad_value, {"accuracy", "2"}));
  const std::vector<double> hard{1e-2, 2e-12};
  const std::vector<WhatIf> table = what_if(d, scene, hard);
  REQUIRE(table.size() == 1);
  CHECK(table[0].accuracy == 1e-2);
  const titop::Scene large{.band_hz = {0, 60}, .whole_up_to = 3};
  CHECK(says(error_of([&] { what_if(d, large, hard); }), Code::bad_value, {"whole_up_to = 3"}));
}

TEST_CASE("an accuracy that cannot be met: the error names the block that moves there") {
  const Error error = error_of([&] {
    compile(frame(slim_beam(5, 0.005)), titop::Scene{.band_hz = {0, 30}, .accuracy = 2e-12});
  });
  CHECK(says(error, Code::bad_value, {"2.0e-12", "keep_structure = false"}));
  REQUIRE(!error.mistakes().front().details.empty());
  const std::string& where = error.mistakes().front().details.front();
  CHECK((has_name(where, "b1") || has_name(where, "b2") || has_name(where, "b3")));
}
