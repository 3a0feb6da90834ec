#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// Every input and every output in units of its own, powers of ten from 1e-9 to 1e9: the difference
/// of two transfers, and its verdict, stay the same.

using namespace titop;
using namespace titop::detail;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;
using titop_test::Rng;

namespace {

const std::vector<Complex> kPoints = {{0.05, 0.7}, {0.2, 3}, {0.5, 9}, {2, 40}};
const Measure kScalars{std::vector<int>(4, 1), std::vector<int>(4, 1)};

using titop::linalg::at;
double unit(Rng& random) { return std::pow(10, random.below(19) - 9); }
VectorXd units(Rng& random) {
  return VectorXd::NullaryExpr(4, [&] { return unit(random); });
}

/// Two uncoupled parts. In the first, base and difference of twins: zero by
/// symmetry. In the second, arbitrary.
StateSpace two_parts(Rng& random) {
  // Base, left, right: x'' = -M^-1 K x - 0.1 x', pushed and read at the base and between the twins.
  Eigen::Matrix3d K;
  const double k = random.between(1, 9);
  K << random.between(1, 9) + 2 * k, -k, -k, -k, k, 0, -k, 0, k;
  const Eigen::Vector3d m(random.between(1, 3), 0.7, 0.7);
  MatrixXd A = MatrixXd::Zero(10, 10), B = MatrixXd::Zero(10, 4), C = MatrixXd::Zero(4, 10);
  A.block<3, 3>(0, 3).setIdentity();
  A.block<3, 3>(3, 0) = (-m.cwiseInverse()).asDiagonal() * K;
  A.block<3, 3>(3, 3).diagonal().setConstant(-0.1);
  B(3, 0) = 1 / m(0);
  B(4, 1) = 1 / m(1), B(5, 1) = -1 / m(2);
  C(0, 0) = 1;
  C(1, 1) = 1, C(1, 2) = -1;
  A.bottomRightCorner(4, 4) = 2 * random.matrix(4, 4) - 5 * MatrixXd::Identity(4, 4);
  B.bottomRightCorner(4, 2) = random.matrix(4, 2);
  C.bottomRightCorner(2, 4) = random.matrix(2, 4);
  MatrixXd D = MatrixXd::Zero(4, 4);
  D(3, 3) = 0.4;
  StateSpace model{A, B, C, D, {}, {}, {}};
  return model;
}

StateSpace in_units(StateSpace m, const VectorXd& out, const VectorXd& in) {
  m.B = m.B * in.asDiagonal();
  m.C = out.asDiagonal() * m.C;
  m.D = out.asDiagonal() * m.D * in.asDiagonal();
  return m;
}

double apart(const StateSpace& a, const StateSpace& exact) {
  std::vector<MatrixXcd> of_a, of_exact;
  for (const Complex s : kPoints) {
    of_a.push_back(a.transfer(s));
    of_exact.push_back(exact.transfer(s));
  }
  Measure by = kScalars;
  by.terms = terms(a, kPoints).cwiseMax(terms(exact, kPoints));
  return difference(of_a, of_exact, by).relative;
}

/// Masses of 1 and 0.01 in a chain, pushed at the last `inputs` of them: where the first one is,
/// and how the last one accelerates.
System chain(int masses, int inputs, const std::function<double()>& unit) {
  Diagram d{"chain"};
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < masses; ++i) {
    z.push_back(d.add("z" + std::to_string(i),
                      SpringMass{.mass = i % 2 ? 0.01 : 1.0, .stiffness = 3e6, .damping = 0.01}));
    if (i > 0)
      mount(z[at(i)], z[at(i - 1)].child);
    else
      ground(z[0]);
  }
  for (int i = masses - inputs; i < masses; ++i)
    z[at(i)].child.force += unit() * d.input("u" + std::to_string(i));
  d.output("x") = unit() * z.front().position;
  d.output("a") = unit() * z.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// Equal up to the effect of another rounding of the coefficients; up to 2.2e-14 all is rounding,
/// by chance down to a tenth of it.
void check_alike(double a, double b) {
  constexpr double rounding = 100 * std::numeric_limits<double>::epsilon();
  CHECK(a <= 5 * std::max(b, rounding));
  CHECK(b <= 5 * std::max(a, rounding));
}

}  // namespace

TEST_CASE("the difference of two transfers is the same number in all units") {
  Rng random(20261122);
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    const StateSpace right = two_parts(random);
    const VectorXd out = units(random), in = units(random);
    const auto of = [&](const StateSpace& wrong) {
      return std::pair(apart(wrong, right),
                       apart(in_units(wrong, out, in), in_units(right, out, in)));
    };
    // One output a millionth too large: that far apart are all its pairs.
    StateSpace wrong = right;
    const Index row = random.below(4);
    wrong.C.row(row) *= 1 + 1e-6, wrong.D.row(row) *= 1 + 1e-6;
    const auto [one, scaled_one] = of(wrong);
    CHECK(std::abs(one / 1e-6 - 1) <= 1e-8);
    CHECK(std::abs(scaled_one / 1e-6 - 1) <= 1e-8);
    // A fault anywhere in A; if it breaks the symmetry of twins, it appears in entries that were 0.
    wrong = right;
    const Index at = random.below(10);
    wrong.A.row(at) *= 1 + 1e-6;
    const auto [any, scaled_any] = of(wrong);
    CHECK(std::abs(scaled_any / any - 1) <= 1e-6);
    CHECK((any > 1e-8) == (scaled_any > 1e-8));
    // The same model in other states: rounding alone.
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(random.matrix(10, 10)).householderQ();
    wrong = {
        Q.transpose() * right.A * Q, Q.transpose() * right.B, right.C * Q, right.D, {}, {}, {}};
    const auto [none, scaled_none] = of(wrong);
    CHECK(none <= 1e-8);
    CHECK(scaled_none <= 1e-8);
  }
}

TEST_CASE("a pair between parts that know nothing of each other may not differ at all") {
  Rng random(7);
  const StateSpace right = two_parts(random);
  StateSpace wrong = right;
  wrong.D(0, 3) = 1e-12;  // 1e-12 of any entry is too large for an exact zero
  CHECK(apart(wrong, right) >= 1);
  const VectorXd out = units(random), in = units(random);
  CHECK(apart(in_units(wrong, out, in), in_units(right, out, in)) >= 1);
}

TEST_CASE("a fault as large as the pair is one, however many digits double has lost") {
  for (const double delta : {1e-8, 1e-10, 1e-11}) {
    CAPTURE(delta);
    Diagram d{"ring"};
    auto u = d.input("u");
    auto K = d.add("K", Gain{.gain = (1 - delta) / 0.7}), G = d.add("G", Gain{.gain = 0.7});
    K.in = G.out;
    G.in = K.out + u;
    d.output("y") = G.out;
    const System system = compile(d);
    const std::vector<MatrixXcd> exact{system.transfer(0, Precision::standard)},
        twice{2 * exact[0]};
    // The allowance for rounding is far above the pair itself: it must not be its scale.
    CHECK(terms(data_of(system), {0})(0, 0) >= 1e5 * std::abs(exact[0](0, 0)));
    Measure by{{1}, {1}};
    CHECK(difference(twice, exact, by, data_of(system), {0}).relative >= 0.5);
  }
}

TEST_CASE("twins leave, in whatever units their base is pushed and watched: order 4 of 6") {
  Rng random(11);
  for (int i = 0; i < 30; ++i) {
    Diagram d{"twins"};
    auto base = d.add("base", SpringMass{.mass = 4, .stiffness = 64, .damping = 0.02});
    auto l = d.add("l", SpringMass{.mass = 1, .stiffness = 25, .damping = 0.01});
    auto r = d.add("r", SpringMass{.mass = 1, .stiffness = 25, .damping = 0.01});
    ground(base);
    mount(l, base.child);
    mount(r, base.child);
    base.child.force += unit(random) * d.input("u") + unit(random) * d.input("v");
    d.output("x") = unit(random) * base.stretch;
    d.output("a") = unit(random) * base.child.accel;
    d.output("between") = unit(random) * (l.stretch - r.stretch);
    const System system = compile(d);
    const OrderVerdict& v = system.order_verdict();
    CAPTURE(to_string(v));
    CHECK(v.order == 4);
    CHECK(v.decided());
    CHECK(v.change <= 1e-10);
    CHECK(certify(system).holds());
  }
}

TEST_CASE("outputs that nothing can move but rounding: no fault, in whatever units") {
  // A parallelogram of links of length 1 in its plane, made of joints with six degrees of freedom.
  Rng random(13);
  for (int i = 0; i < 20; ++i) {
    Diagram d{"parallelogram"};
    const auto link = [] {
      return RigidBody{.mass = 2,
                       .inertia = Eigen::Matrix3d::Identity() / 6,
                       .PA = {0.5, 0, 0},
                       .children = {{"C", {1, 0, 0}}}};
    };
    auto base = d.add("base", RigidBody{.mass = 1, .children = {{"J1"}, {"J2", {1, 0, 0}}}});
    auto crank = d.add("crank", link()), coupler = d.add("coupler", link()),
         rocker = d.add("rocker", link());
    ground(base);
    const double angle = 1.1;
    const Rotation up = Rotation::about({0, 0, 1}, angle),
                   down = Rotation::about({0, 0, 1}, -angle);
    const Eigen::Vector3d z{0, 0, 1};
    hinge(d, "p1", crank, base.child("J1"), up, z).torque = 0;
    auto p2 = hinge(d, "p2", coupler, crank.child, down, z);
    p2.torque = 30 * p2.angle;
    hinge(d, "p3", rocker, base.child("J2"), up, z).torque = 0;
    auto p4 = d.add("p4", Hinge{z});
    p4.torque = 0;
    mount(p4, rocker.child, down);
    weld(coupler.child, p4.child);
    crank.child("C").force += d.input("F", 6);
    d.output("turn") = unit(random) * p2.angle;
    d.output("in plane") = unit(random) * coupler.child.accel.along({0, 1, 0});
    d.output("out of it") = unit(random) * coupler.child.accel.along({0, 0, 1});
    d.output("about y") = unit(random) * rocker.child.accel.about({0, 1, 0});
    const System system = compile(d);
    CHECK(system.state_space().order() == 2);
    const FullCertificate c = certify(system);
    CAPTURE(to_string(c));
    CHECK(c.holds());
  }
}

TEST_CASE("errors of the dense model are the same in all units, for few inputs and many") {
  Rng random(17);
  for (const auto& [masses, inputs] : {std::pair(6, 1), std::pair(6, 2), std::pair(12, 12)}) {
    CAPTURE(inputs);
    const System in_m = chain(masses, inputs, [] { return 1.0; });
    in_m.state_space();
    const Certificate right = in_m.dense_certificate();
    CHECK(right.dense_error <= 1e-11);  // no significant loss
    CHECK(right.dense_error_where_small >= 1e-9);
    for (int i = 0; i < 10; ++i) {
      const System system = chain(masses, inputs, [&] { return unit(random); });
      system.state_space();
      const Certificate c = system.dense_certificate();
      check_alike(c.dense_error, right.dense_error);
      check_alike(c.dense_error_where_small, right.dense_error_where_small);
      // No loss beside the largest outputs: at most that of the small ones is told.
      CHECK(titop_test::count_notes(system, Note::Kind::warning, "dense", {"A, B, C, D"}) <=
            (c.dense_error_where_small > 1e-6 ? 1 : 0));
    }
  }
}

TEST_CASE("an entry of 1e-17 of its row and column is no loss of digits") {
  // A 0 after a rotation of frames has digits in the factors, and others in A, B, C, D.
  const System system =
      compile(titop::generate::random_diagram(titop::generate::random_options(186)).build());
  const StateSpace& dense = system.state_space();
  const Certificate c = system.dense_certificate();
  CHECK(c.dense_error <= 1e-12);
  for (const Complex s : {Complex(1e-4, 3e-4), Complex(1, 3)}) {
    const MatrixXcd right = system.transfer(s, Precision::digits50);
    const VectorXd rows = right.rowwise().lpNorm<Eigen::Infinity>(),
                   columns = right.colwise().lpNorm<Eigen::Infinity>();
    const MatrixXd around = rows.cwiseSqrt() * columns.cwiseSqrt().transpose();
    CHECK(((dense.transfer(s) - right).cwiseAbs().array() <= 1e-12 * around.array()).all());
  }
}
