#include <doctest/doctest.h>

#include <Eigen/LU>
#include <optional>
#include <titop/compiler/solve/joint.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

#include "support/transfer_error.hpp"

/// Two rows of bodies that springs couple from body to body: every row of the equations reads
/// positions all along the rows. Work by counts, transfers against matrices M, C, K.

using namespace titop;
using titop::linalg::at;
using Complex = std::complex<double>;
using Eigen::MatrixXcd, Eigen::Vector3d;

namespace {

using Real = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Wide = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;

struct CoupledRows {
  enum class Base { walls, held };  ///< of the rows: walls, or one body on a spring

  int n;  ///< masses in each row
  Base base = Base::walls;
  double rung_damping = 0;  ///< N s/m of the couplings; their stiffness is 3 N/m
  double tip_spring = 0;    ///< N/m from the tip of a row to its third mass
  double rod_stiffness = 12;

  Diagram diagram() const;
  /// Outputs: the second row's tip against the third mass of the first row, its acceleration.
  MatrixXcd exact(Complex s) const;
};

constexpr double kRung = 3, kDamping = 0.1, kBase = 5, kHold = 7;

Diagram CoupledRows::diagram() const {
  Diagram d{"rows"};
  auto k = d.param("k", rod_stiffness);
  std::vector<SpringMass::Handle> a, b;
  std::optional<SpringMass::Handle> body;
  if (base != Base::walls) {
    body = d.add("base", SpringMass{.mass = kBase, .stiffness = kHold});
    ground(*body);
  }
  for (int i = 0; i < n; ++i) {
    a.push_back(d.add("a" + std::to_string(i),
                      SpringMass{.mass = 1, .stiffness = 10, .damping = kDamping}));
    b.push_back(d.add("b" + std::to_string(i),
                      SpringMass{.mass = 2, .stiffness = Value(k), .damping = kDamping}));
    for (auto* row : {&a, &b}) {
      auto& now = row->back();
      if (i > 0)
        mount(now, (*row)[at(i - 1)].child);
      else if (body)
        mount(now, body->child);
      else
        ground(now);
    }
    const auto force = kRung * (b.back().child.position - a.back().child.position) +
                       rung_damping * (b.back().child.rate - a.back().child.rate);
    a.back().child.force += force;
    b.back().child.force += -force;
  }
  if (tip_spring != 0) {
    const auto force = tip_spring * (a.back().child.position - a[2].child.position);
    a.back().child.force += -force;
    a[2].child.force += force;
  }
  b.back().child.force += d.input("u");
  d.output("x") = b.back().child.position - a[2].child.position;
  d.output("a") = b.back().child.accel;
  return d;
}

MatrixXcd CoupledRows::exact(Complex s) const {
  const Eigen::Index size = 2 * n + 1;  // the base, or the walls, last
  Real M = Real::Zero(size, size), C = M, K = M;
  const auto link = [&](Eigen::Index i, Eigen::Index j, double stiffness, double damping) {
    for (const auto& [p, q, sign] : {std::tuple(i, i, 1), {j, j, 1}, {i, j, -1}, {j, i, -1}}) {
      K(p, q) += sign * static_cast<long double>(stiffness);
      C(p, q) += sign * static_cast<long double>(damping);
    }
  };
  const auto b = [&](int i) { return Eigen::Index{n} + i; };
  for (int i = 0; i < n; ++i) {
    M(i, i) = 1, M(b(i), b(i)) = 2;
    link(i, i > 0 ? i - 1 : 2 * n, 10, kDamping);
    link(b(i), i > 0 ? b(i - 1) : 2 * n, rod_stiffness, kDamping);
    link(i, b(i), kRung, rung_damping);
  }
  if (tip_spring != 0) link(n - 1, 2, tip_spring, 0);
  M(2 * n, 2 * n) = kBase;
  K(2 * n, 2 * n) += kHold;
  const std::complex<long double> z(s.real(), s.imag());
  const Wide all = M.cast<std::complex<long double>>() * (z * z) +
                   C.cast<std::complex<long double>>() * z + K.cast<std::complex<long double>>();
  const Eigen::Index unknowns = base == Base::walls ? size - 1 : size;
  Wide u = Wide::Zero(unknowns, 1);
  u(b(n - 1), 0) = 1;
  const Wide x = all.topLeftCorner(unknowns, unknowns).partialPivLu().solve(u);
  const std::complex<long double> tip = x(b(n - 1), 0);
  MatrixXcd result(2, 1);
  result << Complex(tip - x(2, 0)), Complex(z * z * tip);
  return result;
}

const std::vector<Complex> kPoints{{0.3, 2}, {0.01, 0.7}, {1, 12}};

double error(const System& system, const CoupledRows& rows, bool dense = false) {
  std::vector<MatrixXcd> found, exact;
  for (const Complex s : kPoints) {
    found.push_back(dense ? system.state_space().transfer(s) : system.transfer(s));
    exact.push_back(rows.exact(s));
  }
  return titop_test::transfer_error(found, exact, {1, 1}, {1});
}

double flops_of(const solve::Plan& plan) {
  double flops = 0;
  for (const solve::Front& f : plan.fronts)
    flops += static_cast<double>(f.pivot_count) * static_cast<double>(f.entries());
  return flops;
}

/// Multiplications to eliminate, and terms of the lowered equations.
struct Work {
  double flops = 0, terms = 0;
};
Work work(const CoupledRows& rows) {
  const System system = compile(rows.diagram(), {.minimize_up_to = 0});
  Work result{flops_of(*detail::data_of(system).skeleton->joint.plan)};
  for (const Equation& e : system.stage().graph.equations)
    result.terms += static_cast<double>(e.terms.size());
  return result;
}

}  // namespace

TEST_CASE("coupled rows: work is linear in the number of bodies") {
  using enum CoupledRows::Base;
  for (const auto base : {walls, held})
    for (const double damping : {0.0, 0.2}) {
      CAPTURE(damping);
      const Work few = work({20, base, damping}), many = work({80, base, damping});
      CHECK(many.flops <= 4.4 * few.flops);
      CHECK(many.terms <= 4.4 * few.terms);
    }
}

TEST_CASE("coupled rows: order and transfer as M, C, K, whatever the length") {
  using enum CoupledRows::Base;
  const auto check = [](const CoupledRows& rows) {
    CAPTURE(rows.n);
    CAPTURE(rows.rung_damping);
    CAPTURE(rows.tip_spring);
    const System system = compile(rows.diagram(), {.minimize_up_to = 0});
    CHECK(system.order() == 2 * (2 * rows.n + (rows.base != walls)));
    CHECK(error(system, rows) <= 1e-12);
    if (rows.n <= 13) CHECK(error(system, rows, true) <= 1e-11);
  };
  for (const int n : {3, 12, 13, 20})
    for (const auto base : {walls, held})
      for (const double damping : {0.0, 0.2})
        for (const double tip : {0.0, 4.0}) check({n, base, damping, tip});
  check({80, held, 0.2, 4});
}

TEST_CASE("coupled rows: an update gives the transfer of the new value") {
  for (const auto base : {CoupledRows::Base::walls, CoupledRows::Base::held}) {
    CoupledRows rows{20, base, 0.2, 4};
    const System before = compile(rows.diagram());
    rows.rod_stiffness = 31;
    CHECK(error(before.update({{"k", 31.0}}), rows) <= 1e-12);
  }
}

TEST_CASE("coupled rows of bodies in space: as the equations as written, without a state more") {
  // Two booms alike on a free body, whose translation no coupling reads.
  constexpr int few = 6, many = 13;
  const auto scene = [](int n, double turn) {
    Diagram d{"booms"};
    const Param phi = d.param("phi", turn);
    const RigidBody link{.mass = 2,
                         .inertia = Vector3d(0.3, 0.8, 0.7).asDiagonal(),
                         .PA = {0.2, 0.1, 0},
                         .children = {{"E", {0.7, 0.1, -0.2}}}};
    auto hub = d.add("hub", RigidBody{.mass = 40,
                                      .inertia = Vector3d(9, 8, 7).asDiagonal(),
                                      .children = {{"a", {0, 1, 0}}, {"b", {0, -1, 0.3}}}});
    hub.parent.force = -d.input("U", 6);
    std::vector<BodyHandle> rows[2];
    for (int i = 0; i < n; ++i) {
      for (const int row : {0, 1}) {
        const std::string name = (row ? "b" : "a") + std::to_string(i);
        auto joint = d.add("j" + name, Bushing{.stiffness = {900, 700, 800, 300, 200, 400},
                                               .damping = {1, 2, 1, 3, 1, 2}});
        auto body = d.add(name, link);
        const Rotation T = Rotation::about({0, 0, 1}, Value(phi)) * Rotation::about({1, 0, 0}, 0.4);
        if (i == 0)
          mount(joint, hub.child(row ? "b" : "a"), T);
        else
          mount(joint, rows[row].back().child("E"), T);
        mount(body, joint.child);
        rows[row].push_back(body);
      }
      const auto& a = rows[0].back();
      const auto& b = rows[1].back();
      const Rotation R = Rotation::about({0, 0, 1}, 0);  // they are parallel
      const auto torque =
          50.0 * (R * b.child("E").position.angular() - a.child("E").position.angular()) +
          0.7 * (R * b.child("E").rate.angular() - a.child("E").rate.angular());
      a.child("E").force.angular += torque;
    }
    d.output("a", 6) = rows[1].back().child("E").accel;
    return d;
  };
  const Diagram d = scene(many, 0.2);
  const System system = compile(d, {.minimize_up_to = 0});
  const int rotation = compile(scene(few, 0.2), {.minimize_up_to = 0}).order() - 24 * few;
  CHECK(rotation == 6);  // angles and rates
  CHECK(system.order() == 24 * many + rotation);
  const Complex s(0.3, 4);
  const std::vector<MatrixXcd> written{transfer(d.graph(), s)};
  const auto off = [&](const MatrixXcd& found) {
    return titop_test::transfer_error({found}, written, {3, 3}, {3, 3});
  };
  CHECK(off(system.transfer(s)) <= 1e-9);
  CHECK(off(system.state_space().transfer(s)) <= 1e-8);
  const System turned = compile(scene(many, 0.6), {.minimize_up_to = 0}).update({{"phi", 0.2}});
  CHECK(off(turned.transfer(s)) <= 1e-9);
}

TEST_CASE("a force that reads the tip of a long chain: work as n log n, transfer as K, M") {
  const auto chain = [](int n) {
    Diagram d{"chain"};
    std::vector<SpringMass::Handle> z;
    for (int i = 0; i < n; ++i) {
      z.push_back(d.add("z" + std::to_string(i), SpringMass{.mass = 1, .stiffness = 10}));
      if (i == 0)
        ground(z[0]);
      else
        mount(z[at(i)], z[at(i - 1)].child);
    }
    z[0].child.force += -3.0 * z.back().child.position;
    z.back().child.force += d.input("u");
    d.output("a") = z.back().child.accel;
    return compile(d, {.minimize_up_to = 0});
  };
  const auto flops = [&](int n) {
    return flops_of(*detail::data_of(chain(n)).skeleton->joint.plan);
  };
  CHECK(flops(400) <= 5.5 * flops(100));
  for (const int n : {5, 13, 60}) {
    const std::complex<long double> s(0.3, 2);
    Wide K = Wide::Zero(n, n), u = Wide::Zero(n, 1);
    for (int i = 0; i < n; ++i) {
      K(i, i) = s * s + (i + 1 < n ? 20.0L : 10.0L);
      if (i > 0) K(i, i - 1) = K(i - 1, i) = -10;
    }
    K(0, n - 1) += 3;
    u(n - 1, 0) = s * s;
    const Complex exact(K.partialPivLu().solve(u)(n - 1, 0));
    CHECK(std::abs(chain(n).transfer({0.3, 2})(0, 0) - exact) <= 1e-12 * std::abs(exact));
  }
}
