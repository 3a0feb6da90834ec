#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"
#include "support/names.hpp"
#include "support/rng.hpp"

/// Loops of more than 120 unknowns, whose margin is not computed: exactly singular ones, whose
/// smallest pivots may be ordinary, and nearly singular ones, which keep digits.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

/// out = in, in = (1 - L) out + u, gain by gain: L out = u.
Diagram by_gains(const MatrixXd& L) {
  const auto n = static_cast<int>(L.rows());
  Diagram d{"gains"};
  auto u = d.input("u", n);
  std::vector<Gain::Handle> g;
  for (int i = 0; i < n; ++i) g.push_back(d.add(fmt::format("g{}", i), Gain{.gain = 1}));
  for (int i = 0; i < n; ++i) {
    Expr sum = MatrixXd(MatrixXd::Identity(n, n).row(i)) * u;
    for (int j = 0; j < n; ++j)
      if (const double w = (i == j) - L(i, j); w != 0)
        sum = sum + w * g[static_cast<std::size_t>(j)].out;
    g[static_cast<std::size_t>(i)].in = sum;
  }
  for (int i = 0; i < n; ++i) d.output(fmt::format("y{}", i)) = g[static_cast<std::size_t>(i)].out;
  return d;
}

/// The same with one matrix of gains.
Diagram by_matrix(const MatrixXd& L) {
  const auto n = static_cast<int>(L.rows());
  Diagram d{"matrix"};
  auto u = d.input("u", n);
  auto k = d.add("K", MatrixGain{MatrixXd(MatrixXd::Identity(n, n) - L)});
  auto one = d.add("one", MatrixGain{MatrixXd(MatrixXd::Identity(n, n))});
  k.in = one.out;
  one.in = k.out + u;
  d.output("y", n) = one.out;
  return d;
}

/// Sixteenths: sums and multiples by powers of two are exact.
double sixteenths(Rng& rng) { return (rng.below(33) - 16) / 16.0; }

/// 1 on the diagonal, a ring, and `per` more entries in each row.
MatrixXd sparse(Rng& rng, int n, double per) {
  MatrixXd L = MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j && (rng.chance(per / n) || j == (i + 1) % n)) L(i, j) = sixteenths(rng);
  return L;
}

MatrixXd full(Rng& rng, int n) {
  MatrixXd L(n, n);
  for (double& entry : L.reshaped()) entry = sixteenths(rng);
  return L;
}

/// One row, or column, becomes a sum of others, times powers of two, plus `distance` times what it
/// was: the rank is n - 1 exactly for 0.
MatrixXd near_singular(MatrixXd L, Rng& rng, double distance) {
  const bool column = rng.chance(0.5);
  if (column) L.transposeInPlace();
  std::vector<int> rows;
  for (int i = 0; i < static_cast<int>(L.rows()); ++i) rows.push_back(i);
  rng.shuffle(rows);
  L.row(rows[0]) *= distance;
  const int count = 2 + rng.below(3);
  for (int k = 1; k <= count; ++k) {
    const int power = rng.below(3) - 1;
    L.row(rows[0]) += std::ldexp(rng.sign(), power) * L.row(rows[static_cast<std::size_t>(k)]);
  }
  if (column) L.transposeInPlace();
  return L;
}

/// Of these some 10 % have ordinary pivots in double if the distance is 0.
MatrixXd large(std::uint64_t seed, double distance) {
  Rng rng(seed);
  const int n = 62 + rng.below(30);
  return near_singular(sparse(rng, n, 2 << seed % 3), rng, distance);
}

double error_of(const Diagram& d, const MatrixXd& L) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const MatrixXd right = Long(L.cast<long double>()).partialPivLu().inverse().cast<double>();
  const MatrixXd G = compile(d, {.minimize_up_to = 0}).transfer({0.1, 1}).real();
  return (G - right).cwiseAbs().maxCoeff() / right.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("solver: every exactly singular loop of more than 120 unknowns is refused") {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 180; ++seed) {
    CAPTURE(seed);
    refused += compile_error(by_gains(large(seed, 0))).has(Code::ill_posed);
  }
  CHECK(refused == 180);
}

TEST_CASE("solver: also as one matrix of gains, and of 5 to 90 channels") {
  for (const int n : {5, 20, 61, 90}) {
    CAPTURE(n);
    Rng rng(static_cast<std::uint64_t>(n));
    CHECK(compile_error(by_matrix(near_singular(full(rng, n), rng, 0))).has(Code::ill_posed));
  }
}

TEST_CASE("solver: a large singular loop is named, and no block beside it") {
  Diagram d = by_gains(large(3, 0));
  auto other = d.add("other", Gain{.gain = 2});
  other.in = d.input("v");
  d.output("z") = other.out;
  const Error e = compile_error(d);
  CHECK(e.has(Code::ill_posed));
  int named = 0;
  for (int i = 0; i < 92; ++i) named += has_name(e.what(), fmt::format("g{}.in", i));
  CHECK(named >= 2);
  CHECK_FALSE(has_name(e.what(), "other"));
}

TEST_CASE("solver: loops 1e-6 and 1e-9 from singular, and regular ones, are solved") {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    CAPTURE(seed);
    const double distance = seed % 2 ? 1e-6 : 1e-9;
    const MatrixXd near = large(seed, distance);
    CHECK(error_of(by_gains(near), near) <= 1e-14 / distance);
    const MatrixXd regular = large(seed, 1);
    CHECK(error_of(by_gains(regular), regular) <= 1e-11);
  }
}
