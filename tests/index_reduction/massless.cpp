#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/compiler/definition/transfer.hpp>
#include <titop/graph/linalg/eigen.hpp>

#include "scenes/by_hand.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Scenes whose state space is singular as written and whose transfer is proper: points without
/// mass between springs, forces on them. Reduced to the order of M, D and K.

using namespace scenes_test;
using namespace titop;
using namespace titop_test;

namespace {

const std::vector<Complex> kPoints = {{0.2, 0.3}, {0.1, 1.7}, {0.5, 4}, {0.05, 11}};

MatrixXcd column(std::initializer_list<Complex> entries) {
  MatrixXcd m(static_cast<Index>(entries.size()), 1);
  Index i = 0;
  for (const Complex& e : entries) m(i++, 0) = e;
  return m;
}

/// Factors and dense model against an exact transfer; the smallest digits count.
template <class Exact>
double error_against(const System& system, Exact exact) {
  std::vector<MatrixXcd> factored, dense, right;
  for (const Complex s : kPoints) {
    factored.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
    right.push_back(exact(s));
  }
  return std::max(by_hand::transfer_error(factored, right), by_hand::transfer_error(dense, right));
}

/// z is mounted on the point where `at` begins: same motion, and the point has no mass to take a
/// force.
void hang(const SpringMass::Handle& z, const SpringMass::Handle& at) {
  z.parent.accel = at.parent.accel;
  at.parent.force += -z.parent.force;
}

/// wall - k1 - massless point - k2 - mass m under the force u. The wall end of k1 is a locked mass.
struct Series {
  SpringMass one{.mass = 7, .stiffness = 30}, two{.mass = 2, .stiffness = 50};

  Diagram diagram() const {
    Diagram d{"series"};
    auto u = d.input("u");
    auto z1 = d.add("z1", one), z2 = d.add("z2", two);
    z1.child.accel = 0;
    hang(z2, z1);
    z2.child.force = u;
    d.output("a") = z2.child.accel;
    d.output("x") = z2.stretch - z1.stretch;
    d.output("wall") = z1.child.force;
    return d;
  }
};

}  // namespace

TEST_CASE("springs in series through a point without mass: order 2, one spring by its name") {
  const System system = compile(Series{}.diagram());
  const double k = 30.0 * 50 / 80, m = 2;
  CHECK(system.order() == 2);
  CHECK(system.states() == std::vector<std::string>{"z1.stretch", "z1.stretch_rate"});
  CHECK(error_against(system, [&](Complex s) {
          const Complex x = 1.0 / (m * s * s + k);
          return column({s * s * x, x, -k * x});
        }) <= 1e-13);
  const auto poles = system.poles();
  REQUIRE(poles.size() == 1);
  CHECK(relative(poles[0].s, Complex(0, std::sqrt(k / m))) <= 1e-14);
  CHECK(system.certificate().residual <= 1e-14);
}

TEST_CASE("spring-dampers in series: one state more, the point's own") {
  Series scene;
  scene.one.damping = 3, scene.two.damping = 0.7;
  const System system = compile(scene.diagram());
  CHECK(system.order() == 3);
  CHECK(error_against(system, [](Complex s) {
          const Complex g1 = 30.0 + 3.0 * s, g2 = 50.0 + 0.7 * s, g = g1 * g2 / (g1 + g2);
          const Complex x = 1.0 / (2.0 * s * s + g);
          return column({s * s * x, x, -g * x});
        }) <= 1e-13);
  // A damper on one side only leaves the point its state.
  scene.two.damping = 0;
  CHECK(compile(scene.diagram()).order() == 3);
}

TEST_CASE("a free star of springs around a point without mass") {
  // Relative to the point only 4 of 5 springs are independent: sum k_i s_i = 0.
  const std::vector<double> m = {1, 2, 3, 4, 5}, k = {10, 70, 20, 90, 40};
  Diagram d{"star"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (std::size_t i = 0; i < 5; ++i)
    z.push_back(d.add(fmt::format("z{}", i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
  for (std::size_t i = 1; i < 5; ++i) hang(z[i], z[0]);
  z[3].child.force = u;
  for (std::size_t i = 0; i < 5; ++i) d.output(fmt::format("a{}", i + 1)) = z[i].child.accel;
  const System system = compile(d);
  by_hand::Structure a = by_hand::empty(6, 1, 5);
  for (Index i = 0; i < 5; ++i) {
    const double stiffness = k[static_cast<std::size_t>(i)];
    a.M(i, i) = m[static_cast<std::size_t>(i)];
    a.K(i, i) = stiffness, a.K(5, 5) += stiffness;
    a.K(i, 5) = a.K(5, i) = -stiffness;
  }
  a.B(3, 0) = 1;
  a.C.leftCols(5).setIdentity();
  CHECK(system.order() == 8);
  CHECK(error_against(system, [&](Complex s) { return by_hand::accel_transfer(a, s); }) <= 1e-12);
  CHECK(noted(system, Note::Kind::info, "reduce", {"2 states"}));
}

TEST_CASE("a force on the point between two springs: proper for the mass, not for the point") {
  const auto scene = [](bool point) {
    Diagram d{"loaded"};
    auto u = d.input("u");
    auto z1 = d.add("z1", SpringMass{.mass = 7, .stiffness = 30}),
         z2 = d.add("z2", SpringMass{.mass = 2, .stiffness = 50});
    z1.child.accel = 0;
    z1.parent.force = -u;
    hang(z2, z1);
    d.output("a") = z2.child.accel;
    d.output("x1") = -1.0 * z1.stretch;
    d.output("wall") = z1.child.force;
    if (point) d.output("a1") = z1.parent.accel;
    return d;
  };
  const System system = compile(scene(false));
  const auto exact = [](Complex s) {  // (k1 + k2) x1 - k2 x2 = u, m s^2 x2 = k2 (x1 - x2)
    const Complex c = 50.0 / (2.0 * s * s + 50.0), x1 = 1.0 / (80.0 - 50.0 * c);
    return column({s * s * c * x1, x1, -30.0 * x1});
  };
  CHECK(system.order() == 2);
  CHECK(error_against(system, exact) <= 1e-13);
  // The log names a state that is kept, less a multiple of the input.
  CHECK(std::ranges::any_of(system.states(), [&](const std::string& state) {
    return noted(system, Note::Kind::info, "reduce", {state});
  }));
  CHECK(system.certificate().residual <= 1e-14);
  CHECK(system.dense_certificate().dense_error <= 1e-6);
  // The factors agree for any x and u, and so do the sparse matrices.
  const StateSpace& m = system.state_space();
  const Eigen::Vector2d x(0.3, -1.1);
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 0.7);
  const System::Rates r = system.apply(x, u);
  CHECK((r.xdot - (m.A * x + m.B * u)).norm() <= 1e-14 * r.xdot.norm());
  CHECK((r.y - (m.C * x + m.D * u)).norm() <= 1e-14 * r.y.norm());
  const Descriptor e = system.descriptor();
  const Complex s{0.1, 1.7};
  const MatrixXcd pencil = s * MatrixXd(e.E) - MatrixXd(e.A), B = MatrixXd(e.B).cast<Complex>();
  const MatrixXcd v = pencil.partialPivLu().solve(B);
  const MatrixXcd G = MatrixXd(e.C) * v + MatrixXd(e.D);
  CHECK(matrix_error(G, exact(s)) <= 1e-12);

  const Error e_point = compile_error(scene(true));
  CHECK(needs_derivatives(e_point, "u", "a1", 2));
  CHECK(says(e_point, Code::improper,
             {"z1.parent.force = ", "z1", "0", "SpringMass{.parent_mass = ...}"}));
}

TEST_CASE("a force on a free end without mass: motion of the mass behind it, position of the end") {
  const auto scene = [](double damping, bool accel) {
    Diagram d{"pulled"};
    auto u = d.input("u");
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 50, .damping = damping});
    z.parent.force = -u;
    d.output("a") = z.child.accel;
    d.output("x") = z.parent.position;
    if (accel) d.output("end") = z.parent.accel;
    return d;
  };
  for (const double c : {0.0, 3.0}) {
    CAPTURE(c);
    const System system = compile(scene(c, false));
    CHECK(system.order() == (c == 0 ? 2 : 3));  // x_C, and the damper's stretch
    CHECK(error_against(system, [&](Complex s) {
            const Complex x_C = 1.0 / (2.0 * s * s);
            return column({0.5, x_C + 1.0 / (50.0 + c * s)});
          }) <= 1e-12);
  }
  CHECK(needs_derivatives(compile_error(scene(0, true)), "u", "end", 2));
  CHECK(needs_derivatives(compile_error(scene(3, true)), "u", "end", 1));
}

TEST_CASE("bodies without mass between bushings: their compliances add up, in rotated frames") {
  const Rotation T = Rotation::about({1, 2, -1}, 0.7);
  const SixAxes k1{4e3, 5e3, 6e3, 70, 80, 90}, k2{9e3, 2e3, 3e3, 50, 20, 60};
  const Matrix3d I = Vector3d(0.5, 0.7, 0.9).asDiagonal();
  for (const bool with_body : {false, true}) {
    CAPTURE(with_body);
    Diagram d{"bushings"};
    auto U = d.input("U", 6);
    auto b1 = d.add("b1", Bushing{.stiffness = k1}), b2 = d.add("b2", Bushing{.stiffness = k2});
    auto A = d.add("A", RigidBody{.mass = 3, .inertia = I, .children = {{"C", {0, 0, 0}}}});
    ground(b1);
    if (with_body) {  // without mass and inertia, and turned
      auto N = d.add(
          "N", RigidBody{.mass = 0, .inertia = Matrix3d::Zero(), .children = {{"C", {0, 0, 0}}}});
      mount(N, b1.child, T);
      mount(b2, N.child);
    } else {
      mount(b2, b1.child, T);
    }
    mount(A, b2.child);
    A.child.force = U;
    d.output("a", 6) = A.parent.accel;
    const System system = compile(d);
    by_hand::Structure a = by_hand::empty(6, 6, 6);
    a.M.diagonal() << 3, 3, 3, 0.5, 0.7, 0.9;
    const Matrix6 R = by_hand::dual(T.nominal());  // components in A to components on the ground
    const Matrix6 compliance = R.transpose() * k1.nominal().inverse() * R + k2.nominal().inverse();
    a.K = compliance.inverse();
    a.B.setIdentity();
    a.C.setIdentity();
    CHECK(system.order() == 12);
    std::vector<MatrixXcd> factored, dense, exact;
    for (const Complex s : kPoints) {
      factored.push_back(system.transfer(s)), dense.push_back(system.state_space().transfer(s));
      exact.push_back(by_hand::accel_transfer(a, s));
    }
    CHECK(by_hand::transfer_error(factored, exact, 3, 3) <= 1e-12);
    CHECK(by_hand::transfer_error(dense, exact, 3, 3) <= 1e-11);
    CHECK(by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(a)) <= 1e-12);
  }
}

TEST_CASE("update from a mass to none and back: the states that can stay keep their names") {
  Diagram d{"light"};
  auto m0 = d.param("m0", 0.5), k = d.param("k", 30.0);
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 7, .stiffness = k, .parent_mass = m0}),
       z2 = d.add("z2", SpringMass{.mass = 2, .stiffness = 50});
  z1.child.accel = 0;
  hang(z2, z1);
  z2.child.force = u;
  d.output("a") = z2.child.accel;
  const auto error = [&](const System& system, double mass, double stiffness) {
    return error_against(system, [&](Complex s) {
      const Complex at_point = 50.0 / (mass * s * s + stiffness + 50.0);
      return column({s * s / (2.0 * s * s + 50.0 - 50.0 * at_point)});
    });
  };
  const System heavy = compile(d);
  CHECK(heavy.order() == 4);
  const System light = heavy.update({{"m0", 0.0}});
  CHECK(light.order() == 2);
  CHECK(error(light, 0, 30) <= 1e-13);
  CHECK(noted(light, Note::Kind::warning, "update"));
  CHECK(says(error_of([&] {
               light.update({{"m0", -1.0}});
             }),
             Code::bad_inertia, {"z1", "parent_mass -1"}));
  // 60 is stiffer than 50: by itself the other spring would follow. The states stay.
  const System stiffer = light.update({{"k", 60.0}});
  CHECK(stiffer.states() == light.states());
  CHECK(error(stiffer, 0, 60) <= 1e-13);
  const System again = stiffer.update({{"m0", 0.5}, {"k", 30.0}});
  CHECK(again.states() == heavy.states());
  CHECK(error(again, 0.5, 30) <= 1e-12);
}

TEST_CASE("accelerations imposed twice: the same one is seen twice, different ones are refused") {
  const auto scene = [](bool same) {
    Diagram d{"twice"};
    auto u = d.input("u", 6), v = d.input("v", 6);
    auto A = d.add(
        "A", RigidBody{.mass = 2, .inertia = Matrix3d::Identity(), .children = {{"C", {1, 0, 0}}}});
    auto z = d.add("z", SpringMass{.mass = 3, .stiffness = 20});
    A.parent.accel = u;
    if (same)
      A.child.accel = Eigen::MatrixXd(tau({-1, 0, 0})) * u;
    else
      A.child.accel = v;
    mount(z, A.child.along({0, 1, 0}));
    d.output("a") = z.child.accel;
    if (same) d.output("v", 6) = v;
    return d;
  };
  const System system = compile(scene(true));
  const Complex s{0.3, 2.2}, follows = 20.0 / (3.0 * s * s + 20.0);
  MatrixXcd exact = MatrixXcd::Zero(1, 6);  // at C along y: y and about z of P, 1 m away
  exact(1) = exact(5) = follows;
  CHECK((system.transfer(s).topLeftCorner(1, 6) - exact).cwiseAbs().maxCoeff() <= 1e-14);
  CHECK(says(compile_error(scene(false)), Code::structure,
             {"A.child(\"C\").accel", "A.parent.accel", "A.child(\"C\").force", "A.parent.force"}));
}

TEST_CASE("a locked point that the modes move in one way only: the body follows in the others") {
  ModalData data;
  data.omega = Eigen::VectorXd::Constant(1, 3.0);
  data.xi = Eigen::VectorXd::Constant(1, 0.01);
  data.L_P = Eigen::MatrixXd::Zero(1, 6);
  data.L_P(0, 0) = 1.5;
  data.D_P = rigid_mass(5, Matrix3d::Identity(), Vector3d::Zero());
  data.children.push_back({"C1", {1, 0, 0}, Eigen::MatrixXd::Identity(6, 1) * 0.4});
  Diagram d{"locked"};
  auto u = d.input("u");
  auto B = d.add("B", FlexibleBody(data));
  B.child.accel = 0;  // rank 1 of 6 by itself
  release(B);
  B.parent.force.along({1, 0, 0}) += -1.0 * u;
  d.output("a") = B.parent.accel.along({1, 0, 0});
  const System system = compile(d);
  // Along x alone: x_P + 0.4 eta = 0; (5 x_P + 1.5 eta)'' and (eta + 1.5 x_P)'' + ... by Lagrange.
  CHECK(system.order() == 2);
  CHECK(error_against(system, [](Complex s) {
          // q = eta, x_P = -0.4 q: T = (5 x'^2 + 2 * 1.5 x' q' + q'^2) / 2, V = 9 q^2 / 2.
          const double m = 5 * 0.16 - 2 * 1.5 * 0.4 + 1;
          const Complex q = -0.4 / (m * s * s + 0.06 * s + 9.0);
          return column({-0.4 * q * s * s});
        }) <= 1e-13);
}

TEST_CASE("many points without mass in a long chain: the order is that of the masses") {
  constexpr int n = 60;
  Diagram d{"chain"};
  auto u = d.input("u");
  by_hand::Structure a = by_hand::empty(2 * n, 1, 1);  // masses, then the points between them
  std::vector<SpringMass::Handle> last;
  const auto spring = [&](Index i, Index j, double k) {
    a.K(i, i) += k;
    if (j < 0) return;
    a.K(j, j) += k;
    a.K(i, j) -= k, a.K(j, i) -= k;
  };
  for (int i = 0; i < n; ++i) {
    // mass i - 1 (or the wall) - up - point - down - mass i
    const double k = 100 + 7 * i, m = 1 + 0.1 * (i % 5);
    auto up = d.add(fmt::format("up{}", i), SpringMass{.mass = 0.5, .stiffness = k}),
         down = d.add(fmt::format("down{}", i), SpringMass{.mass = m, .stiffness = 2 * k});
    if (i == 0)
      ground(up.child);
    else
      weld(up.child, last.back().child);
    hang(down, up);
    if (i > 0) a.M(i - 1, i - 1) += 0.5;
    a.M(i, i) += m;
    spring(n + i, i - 1, k);
    spring(n + i, i, 2 * k);
    last.push_back(down);
  }
  last.back().child.force = u;
  d.output("a") = last.front().child.accel;
  a.B(n - 1, 0) = 1, a.C(0, 0) = 1;
  const System system = compile(d, {.minimize_up_to = 0});
  CHECK(system.order() == 2 * n);
  CHECK(error_against(system, [&](Complex s) { return by_hand::accel_transfer(a, s); }) <= 1e-9);
  CHECK(system.certificate().residual <= 1e-13);
}
