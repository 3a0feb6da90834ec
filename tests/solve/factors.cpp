#include <doctest/doctest.h>

#include <algorithm>

#include "sparse_system.hpp"

/// The elimination against dense LU with full pivoting, and its verdict on singular systems.

using namespace solve_test;
using titop::solve::Factors;
using titop::solve::Health;
using titop_test::Rng;

namespace {

/// 2-norm condition number after rows and columns have been given the same size.
double condition(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> svd(A);
  return svd.singularValues()(0) / svd.singularValues().tail(1)(0);
}

Health health_of(const System& s) { return factors_of(s.structure, s.entries).health(); }

}  // namespace

TEST_CASE("solver: solutions as by dense LU on trees, rings, stars, grids and full systems") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    const double diagonal = seed % 3 == 0 ? 0 : 2;
    for (const Kind& kind : kinds(rng)) {
      const System s = random_system(kind.links, kind.n, rng, diagonal);
      const MatrixXd A = s.to_dense(), b = rng.matrix(A.rows(), 3);
      CAPTURE(seed);
      CAPTURE(kind.name);
      const Factors<double> factors = factors_of(s.structure, s.entries);
      REQUIRE(!factors.health().singular);
      const MatrixXd x = solve<double>(factors, b);
      const double backward = (A * x - b).cwiseAbs().maxCoeff() /
                              (A.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs()).maxCoeff();
      CHECK(backward <= 1e-14);
      const MatrixXd exact = A.fullPivLu().solve(b);
      CHECK((x - exact).norm() <= 1e-14 * condition(A) * exact.norm());
    }
  }
}

TEST_CASE("solver: new coefficients row by row, a hundred times: the bits of fresh factors") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Rng rng(seed);
    for (const Kind& kind : {Kind{"chain", chain(40), 40}, Kind{"tree", tree(40, rng), 40},
                             Kind{"grid", grid(6, 6), 36}}) {
      CAPTURE(seed);
      CAPTURE(kind.name);
      System s = random_system(kind.links, kind.n, rng, 2);
      const Factors<double> first = factors_of(s.structure, s.entries);
      const MatrixXd b = rng.matrix(s.size(), 1), x = solve<double>(first, b);
      const auto plan = std::make_shared<const titop::solve::Plan>(first.plan());
      Factors<double> now = first;
      for (int step = 0; step < 100; ++step) {
        const int row = rng.below(kind.n);
        for (MatrixXd& block : s.entries[at(row)]) block *= 1 + 0.1 * rng.matrix(1, 1)(0, 0);
        const EntryRows<double> rows(s.entries);
        now = now.changed(rows, std::vector{row});
        CHECK(now.fronts_made() >= 1);
        CHECK(now.entries_held() >= plan->entries);
        CHECK(now.entries_held() <= 2 * plan->entries);
        const Factors<double> fresh(plan, rows, first.scale());
        for (std::size_t f = 0; f < plan->fronts.size(); ++f) {
          CHECK(std::ranges::equal(now.made(f).lu, fresh.made(f).lu));
          CHECK(std::ranges::equal(now.made(f).order, fresh.made(f).order));
        }
      }
      CHECK(solve<double>(first, b) == x);  // shared fronts are unchanged
    }
  }
}

TEST_CASE("solver: an overflow is told from a singular system, where only inf * 0 shows it, too") {
  Structure structure;
  structure.add_variable(2);
  structure.add_row(2, std::vector{0});
  const MatrixXd A{{1e-160, 0}, {1e160, 1}};  // 1e160 / 1e-160 is above all doubles
  const Health h = factors_of<double>(structure, {{A}}).health();
  CHECK(h.singular);
  CHECK(!h.finite);
  const Eigen::MatrixXcd C = std::complex<double>(1, 1) * A;
  const Health complex = factors_of<std::complex<double>>(structure, {{C}}).health();
  CHECK(complex.singular);
  CHECK(!complex.finite);
}

TEST_CASE("solver: complex systems") {
  Rng rng(5);
  for (const Kind& kind : kinds(rng)) {
    const System re = random_system(kind.links, kind.n, rng, 2);
    System im = re;
    im.from_dense(rng.matrix(re.size(), re.size()));
    std::vector<RowEntries<std::complex<double>>> entries;
    for (std::size_t r = 0; r < re.entries.size(); ++r) {
      entries.emplace_back();
      for (std::size_t k = 0; k < re.entries[r].size(); ++k)
        entries.back().push_back(re.entries[r][k] + std::complex<double>(0, 1) * im.entries[r][k]);
    }
    const Eigen::MatrixXcd A = re.to_dense() + std::complex<double>(0, 1) * im.to_dense();
    const Eigen::MatrixXcd b = rng.matrix(A.rows(), 2).cast<std::complex<double>>();
    const Eigen::MatrixXcd x = solve<std::complex<double>>(factors_of(re.structure, entries), b);
    CAPTURE(kind.name);
    CHECK((A * x - b).norm() <= 1e-13 * A.norm() * x.norm());
  }
}

TEST_CASE("solver: exactly singular systems are refused") {
  int refused = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      System s = random_system(kind.links, kind.n, rng, 2);
      const auto last = s.structure.row_size.size() - 1;
      CAPTURE(seed);
      CAPTURE(kind.name);
      // A group of rows of rank 0: nothing determines its unknown.
      System empty = s;
      for (MatrixXd& block : empty.entries[last]) block.setZero();
      CHECK(health_of(empty).singular);
      // Two equal columns inside a group, or a column of zeros: exact in any arithmetic.
      System equal = s;
      for (std::size_t r = 0; r <= last; ++r)
        for (std::size_t k = 0; k < equal.entries[r].size(); ++k)
          if (equal.structure.row(static_cast<int>(r))[k] == static_cast<int>(last)) {
            MatrixXd& block = equal.entries[r][k];
            if (block.cols() > 1)
              block.col(1) = block.col(0);
            else
              block.setZero();
          }
      CHECK(health_of(equal).singular);
      ++all;
      refused += health_of(equal).singular;
    }
  }
  CHECK(refused == all);
}

namespace {

/// The chain 1 - 2 - ... with a vector v in its null space, up to `distance` in one entry of it:
/// each row's diagonal entry makes row * v = 0.
System near_singular(const Links& links, int n, Rng& rng, double distance) {
  System s = random_system(links, n, rng, 0);
  MatrixXd A = s.to_dense();
  const VectorXd v = VectorXd::Constant(A.cols(), 1.5) + VectorXd(rng.matrix(A.cols(), 1));
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    A(i, i) = 0;
    A(i, i) = -A.row(i).dot(v) / v(i);
  }
  A(0, 0) *= 1 + distance;
  s.from_dense(A);
  return s;
}

}  // namespace

TEST_CASE("solver: singular but for rounding: refused, or at least reported as weak") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      CAPTURE(seed);
      CAPTURE(kind.name);
      const Health health = health_of(near_singular(kind.links, kind.n, rng, 0));
      CAPTURE(health.weakest);
      CHECK((health.singular || health.weakest <= 1e-13));
    }
  }
}

TEST_CASE("solver: the distance from singular shows in the weakest pivot") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (const double distance : {1e-4, 1e-8, 1e-11}) {
      Rng rng(seed);
      for (const Kind& kind : kinds(rng)) {
        const System s = near_singular(kind.links, kind.n, rng, distance);
        if (std::abs(s.to_dense()(0, 0)) < 0.1) continue;  // the entry that moves is itself small
        CAPTURE(seed);
        CAPTURE(distance);
        CAPTURE(kind.name);
        const Health health = health_of(s);
        if (distance > 1e-10) CHECK(!health.singular);
        CHECK(health.weakest <= 1e2 * distance);
      }
    }
}

// Rows 1 and 2 are dependent up to their last digits: the remainder of row 2 is noise, and the
// front that receives it has no other entry to show that.
TEST_CASE("solver: a row that is rounding alone does not pass for a good one further up") {
  System s;
  for (int i = 0; i < 4; ++i) s.structure.add_variable(1);
  for (const std::vector<int>& over :
       std::vector<std::vector<int>>{{0, 1}, {0, 1}, {1, 2, 3}, {1, 2, 3}})
    s.structure.add_row(1, over);
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const MatrixXd first = rng.matrix(1, 2), more = rng.matrix(2, 3);
    const double factor = rng.between(0.1, 2);
    s.entries = {{first.col(0), first.col(1)},
                 {factor * first.col(0), factor * first.col(1)},
                 {more.block(0, 0, 1, 1), more.block(0, 1, 1, 1), more.block(0, 2, 1, 1)},
                 {more.block(1, 0, 1, 1), more.block(1, 1, 1, 1), more.block(1, 2, 1, 1)}};
    CAPTURE(i);
    CHECK(health_of(s).singular);
  }
}
