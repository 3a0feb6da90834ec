#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// Loops in which every block feeds every other one. Rounding of many pivots adds up there, and the
/// rounding of an exactly singular loop is taken for a pivot: 50 digits decide.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

/// out = in, in = (1 - L) out + u: L out = u. `nominal`: instead of the first such weight that is
/// not 0, a parameter "w" of this value.
Diagram diagram(const MatrixXd& L, std::optional<double> nominal = {}) {
  const auto n = static_cast<int>(L.rows());
  Diagram d{"dense"};
  auto u = d.input("u", n);
  std::optional<Value> parameter;
  if (nominal) parameter = d.param("w", *nominal);
  std::vector<Gain::Handle> g;
  for (int i = 0; i < n; ++i) g.push_back(d.add(fmt::format("g{}", i), Gain{.gain = 1}));
  for (int i = 0; i < n; ++i) {
    Expr sum = MatrixXd(MatrixXd::Identity(n, n).row(i)) * u;
    for (int j = 0; j < n; ++j)
      if (const double w = (i == j) - L(i, j); w != 0) {
        sum = sum + parameter.value_or(w) * g[static_cast<std::size_t>(j)].out;
        parameter.reset();
      }
    g[static_cast<std::size_t>(i)].in = sum;
  }
  for (int i = 0; i < n; ++i) d.output(fmt::format("y{}", i)) = g[static_cast<std::size_t>(i)].out;
  return d;
}

/// Sixteenths: sums and multiples by powers of two are exact.
double sixteenths(Rng& rng) { return (rng.below(33) - 16) / 16.0; }

MatrixXd full(std::uint64_t seed) {
  Rng rng(seed);
  const int n = 3 + rng.below(6);
  MatrixXd L(n, n);
  for (double& entry : L.reshaped()) entry = sixteenths(rng);
  return L;
}

/// 1 on the diagonal, a few entries off it.
MatrixXd sparse(std::uint64_t seed) {
  Rng rng(seed);
  const int n = 4 + rng.below(10);
  MatrixXd L = MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j && rng.chance(2.5 / n)) L(i, j) = sixteenths(rng);
  return L;
}

/// One row becomes a sum of two to four others, times powers of two: the rank is n - 1 exactly.
MatrixXd made_singular(MatrixXd L, std::uint64_t seed) {
  Rng rng(seed);
  const auto n = static_cast<int>(L.rows());
  std::vector<int> rows;
  for (int i = 0; i < n; ++i) rows.push_back(i);
  rng.shuffle(rows);
  const std::size_t count = static_cast<std::size_t>(2 + rng.below(std::min(n - 2, 3)));
  L.row(rows[0]).setZero();
  for (std::size_t k = 1; k <= count && k < rows.size(); ++k) {
    const int power = rng.below(3) - 1;
    L.row(rows[0]) += std::ldexp(rng.sign(), power) * L.row(rows[k]);
  }
  return L;
}

/// The wall, a spring, a point without mass, a spring, a mass.
void add_point_without_mass(Diagram& d) {
  auto first = d.add("first", SpringMass{.mass = 7, .stiffness = 3});
  auto second = d.add("second", SpringMass{.mass = 2, .stiffness = 5});
  first.child.accel = 0;
  second.parent.accel = first.parent.accel;
  first.parent.force = -second.parent.force;
  second.child.force = d.input("v");
  d.output("x") = second.stretch;
}

/// The same loop with stretches of two masses for u, and a force on one of them that reads `out`: a
/// singular L makes a constraint of the stretches, and its force.
Diagram between_masses(const MatrixXd& L) {
  const auto n = static_cast<int>(L.rows());
  Diagram d{"between masses"};
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 10});
  auto z2 = d.add("z2", SpringMass{.mass = 2, .stiffness = 20});
  ground(z1);
  mount(z2, z1.child);
  std::vector<Gain::Handle> g;
  for (int i = 0; i < n; ++i) g.push_back(d.add(fmt::format("g{}", i), Gain{.gain = 1}));
  Expr force = 1.0 * d.input("u");
  for (int i = 0; i < n; ++i) {
    const auto& own = g[static_cast<std::size_t>(i)];
    Expr sum = (1 + 0.25 * (i % 3)) * z1.stretch + (-0.5 + 0.5 * (i % 2)) * z2.stretch;
    for (int j = 0; j < n; ++j)
      if (const double w = (i == j) - L(i, j); w != 0)
        sum = sum + w * g[static_cast<std::size_t>(j)].out;
    own.in = sum;
    force = force + (1 + 0.5 * (i % 4)) * own.out;
  }
  z2.child.force = force;
  for (int i = 0; i < n; ++i) d.output(fmt::format("y{}", i)) = g[static_cast<std::size_t>(i)].out;
  return d;
}

/// The certificate's warning that rounding was taken for a pivot: the one without a number.
bool no_digit_is_left(const System& system) {
  return std::ranges::any_of(system.notes(), [](const Note& n) {
    return n.kind == Note::Kind::warning && n.pass == "certify" &&
           n.text.find_first_of("0123456789") == std::string::npos;
  });
}

}  // namespace

TEST_CASE("1000 exactly singular loops, dense or nearly: every one is refused") {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    const Error e =
        compile_error(diagram(made_singular(seed % 2 ? full(seed) : sparse(seed), seed + 7)));
    refused += e.has(Code::ill_posed);
  }
  CHECK(refused == 1000);
}

TEST_CASE("beside a point without mass, whose reduction comes first, they are refused as well") {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    const MatrixXd L = made_singular(full(seed), seed + 7);
    Diagram d = diagram(L);
    add_point_without_mass(d);
    CHECK(std::string(compile_error(d).what()) == compile_error(diagram(L)).what());
  }
}

TEST_CASE("300 loops that a new value makes exactly singular: refused, or said in the log") {
  int regular = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    const MatrixXd L = made_singular(seed % 2 ? full(seed) : sparse(seed), seed + 7);
    double w = 0;
    for (Eigen::Index k = 0; k < L.size() && w == 0; ++k) {
      const Eigen::Index i = k / L.cols(), j = k % L.cols();
      w = (i == j) - L(i, j);
    }
    std::optional<System> before;
    try {
      before = compile(diagram(L, w + 0.3));
    } catch (const Error&) {
      continue;  // this weight alone does not make it regular
    }
    ++regular;
    try {
      const System now = before->update({{"w", w}});
      // Pivots are judged at once, margins at the first query.
      CHECK(no_digit_is_left(now));
    } catch (const Error& e) {
      CHECK(e.has(Code::ill_posed));
      ++refused;
    }
  }
  CHECK(regular >= 100);
  CHECK(refused >= 0.95 * regular);
}

TEST_CASE("singular loops between masses are reduced: the transfer is that of the equations") {
  // Beside a point without mass double takes rounding of seeds 57 and 79 for a pivot after the
  // first reduction.
  int reduced = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    Diagram d = between_masses(made_singular(full(seed), seed + 7));
    add_point_without_mass(d);
    try {
      const System system = compile(d);
      const std::complex<double> s(0.3, 1.7);
      const Eigen::MatrixXcd exact = transfer(d.graph(), s);
      CHECK(matrix_error(system.transfer(s), exact) <= 1e-12);
      CHECK(matrix_error(system.state_space().transfer(s), exact) <= 1e-10);
      ++reduced;
    } catch (const Error& e) {
      CHECK(e.has(Code::ill_posed));  // no constraint of the masses
    }
  }
  CHECK(reduced >= 95);
}

TEST_CASE("500 regular ones: none is refused, and the answer is that of L") {
  double worst = 0;
  int regular = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    CAPTURE(seed);
    const MatrixXd L = seed % 2 ? full(seed) : sparse(seed);
    const Eigen::VectorXd sizes = L.bdcSvd().singularValues();
    if (sizes.minCoeff() < 1e-6 * sizes.maxCoeff()) continue;  // some are singular by chance
    ++regular;
    const Eigen::MatrixXcd G = compile(diagram(L)).transfer({0.1, 1});
    using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Long exact = L.cast<long double>().fullPivLu().inverse();
    worst = std::max(worst, matrix_error(G, exact.cast<double>()));
  }
  CHECK(regular >= 480);
  CHECK(worst <= 1e-12);
}

TEST_CASE("a loop in which rounding stands in a front of its own is refused") {
  // Exactly singular; double finds a pivot of 1e-16 in a front of its own, where nothing cancels.
  const MatrixXd L{{-0.25, 0.5, -0.625, -0.875, -0.9375},
                   {0.9375, 0.875, -0.75, 0.4375, 0.875},
                   {0.5, 1, -1, 0.1875, 0},
                   {-0.6875, 0.4375, -0.5, -0.125, 0.9375},
                   {-0.9375, -1.875, 1.875, 0.34375, 0.0625}};
  const Error e = compile_error(diagram(L));
  CHECK(says(e, Code::ill_posed, {}));
}

TEST_CASE("if double does not decide which rows depend, the error names the loop and the way out") {
  // Row 1 is -2.5 row 0 - 4.5 row 3, exactly: 50 digits detect it, but with the zero threshold of
  // null_rows double finds a pivot in every front.
  MatrixXd L{{64, 44, 60, 60}, {0, 0, 0, 0}, {-28, 0, 64, 48}, {-8, 48, 0, 64}};
  L /= 64;
  L.row(1) = -2.5 * L.row(0) - 4.5 * L.row(3);
  Diagram d = diagram(L);
  auto other = d.add("other", Gain{.gain = 2});
  auto filter = d.add("filter", Lti{.A = MatrixXd{{-1}}, .B = MatrixXd{{1}}, .C = MatrixXd{{1}}});
  other.in = d.input("v");
  filter.in = other.out;
  d.output("z") = filter.out;
  const Error e = compile_error(d);
  CHECK(says(e, Code::ill_posed, {"g0.in, g0.out, g1.in, g1.out, g2.in, g2.out, g3.in, g3.out"}));
  for (const char* beside : {"other", "filter"}) CHECK_FALSE(has_name(e.what(), beside));
}
