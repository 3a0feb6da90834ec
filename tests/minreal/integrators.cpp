#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <support/names.hpp>
#include <support/rng.hpp>
#include <titop/compiler/minreal/effect.hpp>
#include <titop/titop.hpp>

/// Positions and rates of a model that can do with fewer of them: which integrators count.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

std::vector<std::string> numbered(const char* letter, Index count) {
  std::vector<std::string> names;
  for (Index i = 0; i < count; ++i) names.push_back(letter + std::to_string(i));
  return names;
}

StateSpace model(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  return {A,
          B,
          C,
          MatrixXd::Zero(C.rows(), B.cols()),
          numbered("x", A.rows()),
          numbered("u", B.cols()),
          numbered("y", C.rows())};
}

int whole(titop_test::Rng& rng, int low, int high) { return low + rng.below(high - low + 1); }

/// Small whole numbers: up to three poles that are not 0, up to four integrators behind them, some
/// of which follow from the rest or are of no use; rows and columns in any order.
StateSpace whole_numbers(titop_test::Rng& rng) {
  const auto numbers = [&](Index rows, Index cols) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, cols, [&] { return whole(rng, -1, 1); }));
  };
  const Index r = whole(rng, 0, 3), k = whole(rng, 1, 4), inputs = whole(rng, 1, 2),
              outputs = whole(rng, 1, 2);
  MatrixXd A = MatrixXd::Zero(r + k, r + k), B(r + k, inputs), C = numbers(outputs, r + k);
  for (Index i = 0; i < r; ++i) A(i, i) = -1 - static_cast<double>(i);
  for (Index i = 0; i + 1 < r; ++i) A(i, i + 1) = whole(rng, -1, 1);
  MatrixXd N = numbers(k, k);
  for (Index i = 0; i < k; ++i) N.row(i).tail(k - i).setZero();
  // The integrators by themselves, and their part of the rest.
  MatrixXd own = numbers(k, inputs);
  if (k > 1 && whole(rng, 0, 1)) own.row(k - 1) = own.row(k - 2), N.row(k - 1) = N.row(k - 2);
  if (whole(rng, 0, 2) == 0) own.row(0).setZero();
  const MatrixXd X = numbers(k, r), rest = A.topLeftCorner(r, r);
  B.topRows(r) = numbers(r, inputs);
  A.bottomRightCorner(k, k) = N;
  A.bottomLeftCorner(k, r) = X * rest - N * X;
  B.bottomRows(k) = own + X * B.topRows(r);
  if (k > 1 && whole(rng, 0, 1)) C.col(r + k - 1) = -C.col(r + k - 2);
  std::vector<int> order(static_cast<std::size_t>(r + k));
  std::iota(order.begin(), order.end(), 0);
  rng.shuffle(order);
  return model(A(order, order), B(order, Eigen::all), C(Eigen::all, order));
}

/// Compares the order of `system` and requires that it is decided.
void check_order(const System& system, int order) {
  CHECK(system.state_space().order() == order);
  CHECK(system.order_verdict().decided());
}

}  // namespace

TEST_CASE("random integrators in whole numbers: the order is the exact one, the transfer stays") {
  int fewer = 0;
  for (int seed = 0; seed < 2000; ++seed) {
    CAPTURE(seed);
    titop_test::Rng rng(static_cast<std::uint64_t>(seed));
    const StateSpace m = whole_numbers(rng);
    const ExactOrder exact = exact_order(m);
    REQUIRE(exact.decided);
    const Minimized r = minimize(m);
    CHECK(r.model.order() == exact.order);
    CHECK(r.order.decided());
    fewer += exact.order < m.order();
    const std::complex<double> s(0.3, 0.7);
    const MatrixXcd before = m.transfer(s), after = r.model.transfer(s);
    CHECK((before - after).cwiseAbs().maxCoeff() <=
          1e-13 * std::max(1.0, before.cwiseAbs().maxCoeff()));
  }
  CHECK(fewer > 500);
  CHECK(fewer < 1900);
}

/// Required of any model: no order below the minimal one, the true order inside the interval, and
/// the same transfer, with and without the exact order given.
void check_nothing_lost(const StateSpace& m) {
  const int exact = exact_order(m).order;
  const std::complex<double> s(0.3, 0.7);
  const MatrixXcd before = m.transfer(s);
  const double size = std::max(1.0, before.cwiseAbs().maxCoeff());
  const Minimized r = minimize(m), asked = minimize(m, {.exact_order = exact});
  CHECK(r.order.lowest <= exact);
  CHECK(r.order.highest >= exact);
  for (const Minimized* of : {&r, &asked}) {
    CHECK(of->model.order() >= exact);
    CHECK(of->model.order() == of->order.order);
    CHECK((before - of->model.transfer(s)).cwiseAbs().maxCoeff() <= 1e-10 * size);
  }
}

TEST_CASE("Jordan blocks beside integrators: poles that cannot be separated stay whole") {
  int blocks = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    CAPTURE(seed);
    titop_test::Rng rng(static_cast<std::uint64_t>(seed));
    StateSpace m = whole_numbers(rng);
    // The same with one pole in place of up to three.
    for (Index i = 0; i < m.A.rows(); ++i)
      if (m.A(i, i) != 0) m.A(i, i) = -1, ++blocks;
    check_nothing_lost(m);
  }
  CHECK(blocks > 1000);
}

TEST_CASE("poles at 0 that drive others, beside integrators: none is lost, the interval is right") {
  int poles = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    CAPTURE(seed);
    titop_test::Rng rng(static_cast<std::uint64_t>(seed));
    StateSpace m = whole_numbers(rng);
    for (Index i = 0; i < m.A.rows(); ++i)
      if (m.A(i, i) == -3) m.A(i, i) = 0, ++poles;  // x_2, which acts on x_1
    check_nothing_lost(m);
  }
  CHECK(poles > 200);
  // Found among random models: one whose mode at -1 is known to 1e12 of its size next to a double
  // pole at 0, and two whose modes are at the rounding level of the states that act on them.
  MatrixXd A = MatrixXd::Zero(8, 8);
  A.row(0) << -1, 0, 0, 0, 0, 0, 0, 0;
  A(1, 1) = -2, A(1, 2) = 1, A(3, 1) = A(4, 1) = 2, A(5, 0) = 1;
  A(6, 0) = A(6, 5) = -1, A(6, 1) = 2, A(7, 6) = -1;
  check_nothing_lost(model(A, MatrixXd{{0, -2, 1, 0, -2, 2, 2, 0}}.transpose(),
                           MatrixXd{{0, -1, 0, 0, 0, 0, -2, 0}, {2, 0, -2, 0, 0, 0, -1, 0}}));
  A = MatrixXd::Zero(7, 7);
  A(0, 0) = A(0, 2) = A(2, 3) = A(5, 0) = -1, A(1, 1) = -2, A(2, 2) = -3;
  A(4, 2) = A(6, 0) = 2, A(6, 3) = 1;
  check_nothing_lost(
      model(A, MatrixXd{{0, 2, 0, 0, 2, -2, 1}}.transpose(), MatrixXd{{-1, 0, 0, 0, 0, -2, 0}}));
  A = MatrixXd::Zero(4, 4);
  A(0, 0) = -1, A(0, 1) = A(2, 1) = 1, A(3, 1) = 2, A(2, 0) = 1;
  check_nothing_lost(model(A, MatrixXd{{0, 2}, {0, 2}, {-1, 0}, {-1, 0}}, MatrixXd{{1, 0, 0, 0}}));
}

TEST_CASE("two dozen integrators in whole numbers: states removed by rounding are restored") {
  int put_back = 0;
  for (int seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    titop_test::Rng rng(static_cast<std::uint64_t>(seed));
    const Index k = whole(rng, 12, 24), r = 2;
    const auto sparse = [&] {
      const auto entry = whole(rng, -2, 2);
      return entry * (whole(rng, 0, 2) == 0);
    };
    MatrixXd A = MatrixXd::NullaryExpr(r + k, r + k, sparse).triangularView<Eigen::StrictlyLower>();
    A.topLeftCorner(r, r) << -1, 1, 0, -2;
    const MatrixXd C = MatrixXd::NullaryExpr(2, r + k, sparse);
    const StateSpace m = model(A, MatrixXd::NullaryExpr(r + k, 2, sparse), C);
    check_nothing_lost(m);
    const Minimized result = minimize(m);
    if (minreal::minimize_unmeasured(m, {}).order.removed.empty()) continue;
    if (!result.order.removed.empty()) continue;  // they may leave
    ++put_back;
    CHECK(result.model.A == m.A);
    CHECK(!result.order.decided());
  }
  CHECK(put_back > 0);
}

TEST_CASE("entries that are not finite are refused") {
  for (MatrixXd StateSpace::*part : {&StateSpace::A, &StateSpace::B, &StateSpace::C}) {
    StateSpace m = model(MatrixXd::Zero(2, 2), MatrixXd::Ones(2, 1), MatrixXd::Ones(1, 2));
    (m.*part)(0, 0) = std::nan("");
    CHECK_THROWS_AS(minimize(m), Error);
  }
}

TEST_CASE("in other units of states, inputs, outputs and time the same integrators count") {
  int missed = 0;
  for (int seed = 0; seed < 500; ++seed) {
    CAPTURE(seed);
    titop_test::Rng rng(static_cast<std::uint64_t>(seed));
    StateSpace m = whole_numbers(rng);
    const int order = minimize(m).model.order();
    const auto units = [&](Index n) {
      return Eigen::VectorXd(
          Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(10.0, whole(rng, -9, 9)); }));
    };
    const Eigen::VectorXd x = units(m.A.rows()), u = units(m.B.cols()), y = units(m.C.rows());
    const double time = units(1)(0);
    m.A = (time * x.asDiagonal() * m.A * x.cwiseInverse().asDiagonal()).eval();
    m.B = (time * x.asDiagonal() * m.B * u.asDiagonal()).eval();
    m.C = (y.asDiagonal() * m.C * x.cwiseInverse().asDiagonal()).eval();
    const Minimized r = minimize(m);
    CHECK(r.order.highest >= order);
    missed += r.order.lowest > order;
  }
  CHECK(missed <= 2);  // products of three roundings, 32 times one of which count as nothing
}

TEST_CASE("two integrators that are one but for their last places: undecided, and both stay") {
  const auto pair = [](double off) {
    return minimize(model(MatrixXd::Zero(2, 2), MatrixXd{{1, 2}, {1, 2 + off}}, MatrixXd{{1, 1}}));
  };
  const Minimized equal = pair(0), near = pair(1e-13), apart = pair(1e-6);
  CHECK(equal.model.order() == 1);
  CHECK(equal.order.decided());
  CHECK(near.order.lowest <= 1);
  // Outputs depend on their sum alone, for any inputs.
  CHECK(near.model.order() == 1);
  CHECK(apart.model.order() == 1);
  const auto seen_apart = [](double off) {
    return minimize(
        model(MatrixXd::Zero(2, 2), MatrixXd{{1, 2}, {1, 2 + off}}, MatrixXd::Identity(2, 2)));
  };
  CHECK(seen_apart(0).model.order() == 1);
  const Minimized doubtful = seen_apart(1e-13);
  CHECK(doubtful.model.order() == 2);
  CHECK(doubtful.order.lowest == 1);
  CHECK(doubtful.order.highest == 2);
  CHECK(titop_test::has_names(to_string(doubtful.order), {"order 2", "1", "2"}));
  CHECK(seen_apart(1e-6).model.order() == 2);
  CHECK(seen_apart(1e-6).order.decided());
}

TEST_CASE("the caller's rounding decides: a mode below it is removed") {
  StateSpace m =
      model(MatrixXd::Zero(2, 2), MatrixXd{{1, 2}, {1, 2 + 1e-11}}, MatrixXd::Identity(2, 2));
  CHECK(minimize(m).model.order() == 2);
  MinimizeOptions options;
  options.rounding = m;
  for (MatrixXd* entries :
       {&options.rounding.A, &options.rounding.B, &options.rounding.C, &options.rounding.D})
    entries->setZero();
  options.rounding.B(1, 1) = 1e-11;
  CHECK(minimize(m, options).model.order() == 1);
  options.rounding.B.resize(1, 1);  // of no use: as if nothing were known
  CHECK(minimize(m, options).model.order() == 2);
}

TEST_CASE("outputs that read differences of positions need no common motion") {
  Diagram chain{"chain"};
  auto u = chain.input("u");
  auto z1 = chain.add("z1", SpringMass{.mass = 1, .stiffness = 10, .parent_mass = 2}),
       z2 = chain.add("z2", SpringMass{.mass = 3, .stiffness = 20});
  z1.parent.force = u;
  mount(z2, z1.child);
  chain.output("relative") = z2.child.position - z1.parent.position;
  const System free = compile(chain);
  CHECK(free.order() == 6);
  check_order(free, 4);                          // two stretches and their rates
  const OrderVerdict& v = free.order_verdict();  // says why
  CHECK(std::ranges::any_of(v.removed, [&](const JudgedMode& m) {
    return !m.why.empty() && to_string(v).find(m.why) != std::string::npos;
  }));

  // The difference of two points of a rigid body depends on the two rotations across their
  // distance; a single point on its three displacements, each twice integrated.
  for (const bool difference : {true, false}) {
    Diagram d{"rigid"};
    auto U = d.input("U", 6);
    auto hub =
        d.add("hub", RigidBody{.mass = 20,
                               .inertia = Eigen::Vector3d(2, 3, 4).asDiagonal(),
                               .children = {{"A", {0.5, 0.3, 0.1}}, {"B", {-0.5, 0.2, -0.4}}}});
    hub.parent.force = -U;
    if (difference)
      d.output("y", 6) = hub.child("A").position - hub.child("B").position;
    else
      d.output("y", 3) = hub.child("A").position.linear();
    const System system = compile(d);
    CHECK(system.order() == 12);
    check_order(system, difference ? 4 : 6);
  }
}

TEST_CASE("an integrated acceleration that the states hold adds none, as a block of one's own") {
  const MatrixXd one = MatrixXd::Ones(1, 1);
  const Lti twice{.A = MatrixXd{{0, 1}, {0, 0}}, .B = MatrixXd{{0}, {1}}, .C = MatrixXd{{1, 0}}},
      once{.A = 0 * one, .B = 2 * one, .C = 0.5 * one};
  for (const Lti& block : {twice, once}) {
    Diagram d{"grounded"};
    auto u = d.input("u");
    auto z1 = d.add("z1", SpringMass{.mass = 1.3, .stiffness = 10, .damping = 0.2}),
         z2 = d.add("z2", SpringMass{.mass = 3, .stiffness = 21.7});
    ground(z1);
    mount(z2, z1.child);
    z2.child.force += u;
    auto f = d.add("f", block);
    f.in = z2.child.accel;
    d.output("y") = f.out;
    d.output("force") = z2.parent.force;
    check_order(compile(d), 4);
  }
  Diagram d{"free"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 10, .parent_mass = 2});
  z1.parent.force = u;
  auto f = d.add("f", twice);
  f.in = z1.child.accel;
  d.output("x") = f.out;
  d.output("p") = z1.parent.position;
  check_order(compile(d), 4);
}
