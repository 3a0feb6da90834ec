#include <doctest/doctest.h>

#include <cmath>

#include "wild/oracle/draw.hpp"
#include "wild/oracle/model.hpp"
#include "wild/oracle/oracle.hpp"

using namespace wild;

namespace {

using Measured = Reading::Measured;

double off(Complex got, Complex right) { return std::abs(got - right) / std::abs(right); }

Share share_of_input(int input) {
  return {{.measured = Measured::input, .axis = input}, MatrixXd::Identity(1, 1)};
}

Scene one_lti(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, bool fed_back) {
  Scene s;
  Node n;
  n.kind = Node::Kind::lti;
  n.A = A, n.B = B, n.C = C, n.D = MatrixXd::Zero(1, 1);
  n.in = {share_of_input(0)};
  if (fed_back)
    n.in.push_back({{.measured = Measured::out, .at = {0, -1}}, MatrixXd::Identity(1, 1)});
  s.nodes = {n};
  s.inputs = {1};
  s.outputs = {{.measured = Measured::out, .at = {0, -1}}};
  return s;
}

/// n spring-masses of 1 kg, 10 N/m, 20 N s/m on a wall, a force on the tip.
Scene lossy_row(int n) {
  Scene s;
  for (int i = 0; i < n; ++i) {
    Node node;
    node.kind = Node::Kind::mass;
    node.m = 1, node.k = 10, node.c = 20;
    s.nodes.push_back(node);
    s.ties.push_back({.a = {i, -1}, .b = i == 0 ? Point{} : Point{i - 1, 0}});
  }
  s.inputs = {1};
  s.loads = {{{n - 1, 0}, 0, {share_of_input(0)}}};
  s.outputs = {{.measured = Measured::position, .at = {n - 1, 0}},
               {.measured = Measured::reaction, .at = {0, -1}}};
  return s;
}

/// The same by its recursion from the wall, in ratios: exact to rounding, as nothing cancels.
std::pair<Complex, Complex> lossy_row_by_recursion(int n, Complex s) {
  const Complex z = 10.0 + 20.0 * s;
  Complex seen = z, force = z;  // load of the first mass; wall force per position of mass 1
  Complex wall = force;
  for (int i = 1; i < n; ++i) {
    const Complex below = s * s + seen;     // force on mass i per its position
    const Complex ratio = z / (z + below);  // position of mass i per that of mass i + 1
    wall *= ratio;
    seen = z * below / (z + below);
  }
  const Complex x = 1.0 / (s * s + seen);
  return {x, wall * x};
}

}  // namespace

TEST_CASE("the oracle knows controllers by hand") {
  MatrixXd A(3, 3), B = MatrixXd::Zero(3, 1), C(1, 3);
  A << -1, 0, 0, -1, 0, 0, 0, -4, 0;
  B(0) = 1;
  C << 0, 0, 1;
  for (const Digits digits : {Digits::wide, Digits::fifty}) {
    CHECK(off(truth(one_lti(A, B, C, false), {1.0}, digits).H[0](0, 0), 2) <= 1e-15);
    const ModelTransfer model = model_transfer(A, B, C, MatrixXd::Zero(1, 1), {1.0}, 1e-3, digits);
    CHECK(off(model.H[0](0, 0), 2) <= 1e-15);
    // x = (1/2, -1/2, 2), left = (2, -4, 1): 2 (1/2 + 1) + 4 (1/2) + 2 + 2, all terms of one sign
    CHECK(std::abs(model.rounding[0](0, 0) / 9e-3 - 1) <= 1e-14);
  }
  // G = 0.02 / (s^3 + 2.2 s^2 + 0.41 s + 0.02), closed by +1: G / (1 - G).
  A << -2.2, -0.41, -0.02, 1, 0, 0, 0, 1, 0;
  C << 0, 0, 0.02;
  const Complex s(0, 1e-5), closed = 0.02 / (s * (s * (s + 2.2) + 0.41));
  CHECK(off(truth(one_lti(A, B, C, true), {s}).H[0](0, 0), closed) <= 1e-9);
}

TEST_CASE("the oracle knows lossy rows by recursion from the wall") {
  for (const int n : {1, 2, 10, 60})
    for (const Complex s : {Complex(0, 8), Complex(0, 15.93), Complex(0.3, 0.2)}) {
      const auto [x, wall] = lossy_row_by_recursion(n, s);
      for (const Digits digits : {Digits::wide, Digits::fifty}) {
        if (digits == Digits::fifty && n > 10) continue;
        const Truth t = truth(lossy_row(n), {s}, digits);
        CHECK(off(t.H[0](0, 0), x) <= 1e-13);
        CHECK(off(t.H[0](1, 0), wall) <= 1e-12);
      }
    }
  // x'' + 20 x' + 10 x = 1.
  const double w = std::sqrt(90.0), p = -10 + w, q = -10 - w, t = 0.3;
  const double x = 1 / (p * q) + std::exp(p * t) / (p * (p - q)) + std::exp(q * t) / (q * (q - p));
  const VectorXd y = step_response(lossy_row(1), 0, t);
  CHECK(std::abs(y(0) - x) <= 1e-9 * std::abs(x));
}

TEST_CASE("the oracle knows a body tied by its rotation to another that is pinned") {
  // Velocity of b is omega x (0, 1, 0), omega about z by a unit torque on both: inertia 1 + (1 +
  // 1).
  Scene s;
  Node a, b;
  a.sites = {{Vector3d(1, 0, 0), MatrixXd(6, 0)}, {Vector3d(0, 1, 0), MatrixXd(6, 0)}};
  b.sites = {{Vector3d::Zero(), MatrixXd(6, 0)}};
  s.nodes = {a, b};
  s.ties = {{.a = {0, -1}, .b = {}, .of = Tie::Of::linear},
            {.a = {1, -1}, .b = {0, 0}, .of = Tie::Of::angular},
            {.a = {1, 0}, .b = {0, 1}, .of = Tie::Of::linear}};
  s.inputs = {1};
  s.loads = {{{1, 0}, 2, {{{.measured = Measured::input}, Vector3d::UnitZ()}}}};
  s.outputs = {{.measured = Measured::rate, .at = {1, -1}}};
  const Truth t = truth(s, {1.0});
  CHECK((t.H[0].real() - (VectorXd(6) << -1, 0, 0, 0, 0, 1).finished() / 3).norm() <= 1e-15);
}

namespace {

/// L = 2 m, E I_z = 30, E I_y = 12, G J = 4, E A = 50, rho A = 5, rho I_x = 0.2.
Beam plain_beam(int elements) {
  return {.length = 2,
          .area = 10,
          .I_y = 2.4,
          .I_z = 6,
          .J = 2,
          .I_x = 0.4,
          .E = 5,
          .rho = 0.5,
          .G = 2,
          .elements = elements,
          .residual = {},
          .xi = {},
          .sites = {elements}};
}

Scene on_the_ground(const Beam& beam) {
  Scene s;
  Node n;
  n.beam = beam;
  n.sites.resize(beam.sites.size());
  s.nodes = {n};
  s.ties = {{.a = {0, -1}, .b = {}}};
  s.inputs = {6};
  s.loads = {{{0, 0}, 0, {{{.measured = Measured::input}, MatrixXd::Identity(6, 6)}}}};
  s.outputs = {{.measured = Measured::position, .at = {0, 0}},
               {.measured = Measured::reaction, .at = {0, -1}}};
  return s;
}

}  // namespace

TEST_CASE("the oracle knows the statics of a cantilever, from either end") {
  for (const int elements : {1, 3})
    for (const bool from_tip : {false, true}) {
      Beam b = plain_beam(elements);
      if (from_tip) b.parent = elements, b.sites = {0};
      const double sign = from_tip ? -1 : 1, L = 2;
      MatrixXd right = MatrixXd::Zero(6, 6);
      right.diagonal() << L / 50, L * L * L / (3 * 30), L * L * L / (3 * 12), L / 4, L / 12, L / 30;
      right(1, 5) = right(5, 1) = sign * L * L / (2 * 30);
      right(2, 4) = right(4, 2) = -sign * L * L / (2 * 12);
      const MatrixXd got = truth(on_the_ground(b), {1e-12}).H[0].real();
      CHECK((got.topRows(6) - right).norm() <= 1e-13);
      MatrixXd carried = MatrixXd::Identity(6, 6);  // the load and its moment about the root
      carried(5, 1) = sign * L, carried(4, 2) = -sign * L;
      CHECK((got.bottomRows(6) - carried).norm() <= 1e-13);
    }
}

TEST_CASE("the oracle knows the first frequencies and the rigid mass of a beam") {
  const auto pole = [](int component, double right) {
    // Of the tip's response, 1 / (lambda - w^2) times a constant plus other modes.
    const double w = right * (1 - 1e-5);
    const Scene s = on_the_ground(plain_beam(component == 1 || component == 2 ? 12 : 60));
    const auto at_w = [&](double x) {
      return truth(s, {Complex(0, x)}).H[0](component, component);
    };
    return at_w(w).real() > 0 && at_w(right * (1 + 1e-3)).real() < 0;
  };
  const double root = 1.875104068711961 * 1.875104068711961 / 4;
  CHECK(pole(1, root * std::sqrt(30.0 / 5)));
  CHECK(pole(2, root * std::sqrt(12.0 / 5)));
  CHECK(pole(0, std::acos(-1) / 4 * std::sqrt(50.0 / 5)));
  CHECK(pole(3, std::acos(-1) / 4 * std::sqrt(4 / 0.2)));
  Scene s = on_the_ground(plain_beam(2));
  s.ties[0].input = 0;
  s.loads.clear();
  const MatrixXd carried = truth(s, {1e-12}).H[0].real().bottomRows(6);
  // 10 kg at 1 m: reaction of accelerations, and rho A L^3 / 3 about the root.
  MatrixXd rigid = MatrixXd::Zero(6, 6);
  rigid.diagonal() << 10, 10, 10, 0.4, 40.0 / 3, 40.0 / 3;
  rigid(1, 5) = rigid(5, 1) = 10, rigid(2, 4) = rigid(4, 2) = -10;
  CHECK((carried + rigid).norm() <= 1e-13);
}

TEST_CASE("the oracle's modes of a beam sum to its elements, and residual shapes to its statics") {
  Beam b = plain_beam(3);
  b.xi = {0.01};
  b.sites = {3, 1};
  const std::vector<Complex> s = {1e-12, Complex(0.2, 1.3), Complex(0, 40)};
  const Truth elements = truth(on_the_ground(b), s);
  b.kept = 18;
  const Truth modes = truth(on_the_ground(b), s);
  for (std::size_t k = 0; k < s.size(); ++k)
    CHECK((modes.H[k] - elements.H[k]).norm() <= 1e-13 * elements.H[k].norm());
  b.kept = 2;
  const auto loses = [&] {
    const Eigen::MatrixXcd off = truth(on_the_ground(b), s).H[0] - elements.H[0];
    return off.topRows(6).norm() / elements.H[0].topRows(6).norm();
  };
  CHECK(loses() > 1e-3);
  b.residual = {3};
  CHECK(loses() <= 1e-13);
}

TEST_CASE("the oracle knows a plate on a bushing by hand") {
  // 4 kg, inertia 2 kg m^2, centre of mass at the child end; the plate's frame is turned by 90
  // degrees about z against the bushing's, whose parent end is driven.
  Node bushing, plate;
  bushing.kind = Node::Kind::bushing;
  bushing.stiffness = bushing.damping = Matrix6d::Zero();
  bushing.stiffness.diagonal() << 8, 18, 50, 4, 10, 20;
  bushing.stiffness(0, 4) = bushing.stiffness(4, 0) = 2;
  bushing.damping(2, 2) = 3;
  plate.mass = 4;
  plate.inertia *= 2;
  Scene s;
  s.nodes = {bushing, plate};
  s.inputs = {6, 6};
  s.ties = {{.a = {0, -1}, .b = {}, .input = 0}, {.a = {1, -1}, .b = {0, 0}}};
  s.ties[1].T << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  s.loads = {{{1, -1}, 0, {{{.measured = Measured::input, .axis = 1}, MatrixXd::Identity(6, 6)}}}};
  s.outputs = {{.measured = Measured::displacement, .at = {0, -1}},
               {.measured = Measured::reaction, .at = {0, -1}}};
  const Complex z(0.3, 2);
  const Eigen::MatrixXcd H = truth(s, {z}).H[0];
  // A force F of the plate along its y pushes along -x of the bushing: x and ry are coupled.
  const Complex det = (4.0 * z * z + 8.0) * (2.0 * z * z + 10.0) - 4.0;
  CHECK(off(H(0, 7), -(2.0 * z * z + 10.0) / det) <= 1e-14);
  CHECK(off(H(4, 7), 2.0 / det) <= 1e-14);
  CHECK(off(H(6, 7), (-8.0 * (2.0 * z * z + 10.0) + 4.0) / det) <= 1e-14);
  CHECK(off(H(2, 8), 1.0 / (4.0 * z * z + 3.0 * z + 50.0)) <= 1e-14);
  // Its parent end accelerates along z: q = -4 / (4 s^2 + 3 s + 50).
  CHECK(off(H(2, 2), -4.0 / (4.0 * z * z + 3.0 * z + 50.0)) <= 1e-14);
  const MatrixXd still = truth(s, {1e-12}).H[0].real().topRightCorner(6, 6);
  CHECK(std::abs(still(1, 0) - 1.0 / 18) <= 1e-14);
  CHECK(std::abs(still(0, 1) + 10.0 / 76) <= 1e-14);
  CHECK(std::abs(still(4, 1) - 2.0 / 76) <= 1e-14);
}

TEST_CASE("the oracle knows loops of numbers by hand") {
  // x = 3 u + 0.5 y, y = x - 0.25 x' of two entries swapped, and a mass held by its acceleration.
  Node first, second, mass;
  first.kind = second.kind = Node::Kind::lti;
  first.A = second.A = MatrixXd(0, 0), first.B = second.B = MatrixXd(0, 2);
  first.C = second.C = MatrixXd(2, 0);
  first.D = 3 * MatrixXd::Identity(2, 2);
  second.D = MatrixXd::Identity(2, 2);
  second.D(0, 1) = second.D(1, 0) = -0.25;
  const auto out = [](int node) { return Reading{.measured = Measured::out, .at = {node, -1}}; };
  first.in = {{{.measured = Measured::input}, MatrixXd::Identity(2, 2)},
              {out(1), MatrixXd::Identity(2, 2) / 6}};
  second.in = {{out(0), MatrixXd::Identity(2, 2)}};
  mass.kind = Node::Kind::mass;
  mass.m = 4, mass.k = 0, mass.c = 0;
  Scene s;
  s.nodes = {first, second, mass};
  s.inputs = {2};
  s.ties = {{.a = {2, -1}, .b = {}}};
  s.loads = {
      {{2, 0}, 0, {{out(1), MatrixXd::Identity(2, 2).topRows(1)}}},
      {{2, 0}, 0, {{{.measured = Measured::accel, .at = {2, 0}}, MatrixXd::Constant(1, 1, 3.75)}}}};
  s.outputs = {out(1), {.measured = Measured::accel, .at = {2, 0}}};
  // Sum and difference of the entries: y = 3 g u / (1 - g / 2) with g = 3/4 and 5/4.
  const double plus = 2.25 / 0.625, minus = 3.75 / 0.375;
  const Eigen::MatrixXcd H = truth(s, {Complex(0.3, 2)}).H[0];
  CHECK(off(H(0, 0), (plus + minus) / 2) <= 1e-14);
  CHECK(off(H(0, 1), (plus - minus) / 2) <= 1e-14);
  CHECK(off(H(2, 0), (plus + minus) / 2 / 0.25) <= 1e-14);
}

TEST_CASE("64 bits of mantissa and 50 digits agree on all families") {
  const auto families = {draw_row,   draw_tree,     draw_loop,  draw_half_ties, draw_controller,
                         draw_beams, draw_bushings, draw_equal, draw_gains};
  int compared = 0;
  for (const auto draw : families)
    for (std::uint64_t seed = 0; compared < 1000 && seed < 12; ++seed) {
      Rng rng(seed);
      const Scene scene = draw(rng);
      if (scene.nodes.size() > 5) continue;
      const std::vector<Complex> s = {Complex(0.3, 1) * scene.omega};
      const Truth wide = truth(scene, s), fine = truth(scene, s, Digits::fifty);
      if (!wide.none.empty()) continue;
      const double size = fine.H[0].cwiseAbs().maxCoeff();
      if (size < 1e-12) continue;  // no input reaches an output but by rounding of the data
      CHECK((wide.H[0] - fine.H[0]).cwiseAbs().maxCoeff() <= 1e-12 * size);
      ++compared;
    }
  CHECK(compared >= 20);
}
