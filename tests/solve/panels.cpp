#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <titop/compiler/solve/front_elimination.hpp>
#include <vector>

#include "sparse_system.hpp"
#include "support/rng.hpp"

/// Elimination by panels, some steps at a time: the same bits as by whole steps; the steps alone
/// first, then with their pivots as the solver takes them.

namespace {

using solve_test::MatrixXd;
using titop_test::Rng;

template <class T>
T number(Rng& rng) {
  return static_cast<T>(rng.between(-1, 1));
}
template <>
std::complex<double> number(Rng& rng) {
  const double re = rng.between(-1, 1);
  return {re, rng.between(-1, 1)};
}

template <class T>
struct Front {
  std::ptrdiff_t rows, n;
  std::vector<T> a = std::vector<T>(static_cast<std::size_t>(rows * n));
  std::vector<double> bounds = std::vector<double>(a.size());

  Front(std::ptrdiff_t of, std::ptrdiff_t columns, Rng& rng) : rows(of), n(columns) {
    for (std::size_t i = 0; i < a.size(); ++i)
      a[i] = rng.below(4) == 0 ? T(0) : number<T>(rng), bounds[i] = titop::solve::size_of(a[i]);
    for (std::ptrdiff_t i = 0; i < std::min(rows, n); ++i) at(i, i) += T(4);
  }
  T& at(std::ptrdiff_t i, std::ptrdiff_t j) { return a[static_cast<std::size_t>(i * n + j)]; }
  double& bound(std::ptrdiff_t i, std::ptrdiff_t j) {
    return bounds[static_cast<std::size_t>(i * n + j)];
  }
};

/// Step by step, all columns at once, entry by entry.
template <class T>
void whole_steps(Front<T>& f, std::ptrdiff_t pivots) {
  using titop::solve::size_of;
  for (std::ptrdiff_t k = 0; k < pivots; ++k) {
    for (std::ptrdiff_t j = k + 1; j < f.n; ++j)
      if (size_of(f.at(k, j)) > 1e-6 * f.bound(k, j)) f.bound(k, j) = size_of(f.at(k, j));
    for (std::ptrdiff_t i = k + 1; i < f.rows; ++i) {
      if (f.at(i, k) == T(0)) continue;
      const T l = f.at(i, k) = titop::solve::Divisor<T>(f.at(k, k))(f.at(i, k));
      for (std::ptrdiff_t j = k + 1; j < f.n; ++j) {
        titop::solve::subtract(1, l, &f.at(k, j), &f.at(i, j));
        f.bound(i, j) += size_of(l) * f.bound(k, j);
      }
    }
  }
}

template <class T>
void by_panels(Front<T>& f, std::ptrdiff_t pivots, std::ptrdiff_t panel) {
  for (std::ptrdiff_t k = 0; k < pivots; k += panel) {
    const std::ptrdiff_t end = std::min(k + panel, pivots);
    for (std::ptrdiff_t p = k; p < end; ++p)
      titop::solve::eliminate_below(p, end, f.rows, f.n, f.a.data(), f.bounds.data());
    titop::solve::eliminate_right(k, end, f.rows, f.n, f.a.data(), f.bounds.data());
  }
}

template <class T>
void compare() {
  Rng rng(11);
  for (const auto& [rows, columns, pivots] : {std::tuple(7, 9, 7),
                                              {20, 31, 16},
                                              {45, 83, 40},
                                              {40, 40, 40},
                                              {5, 70, 1},
                                              {3, 3, 3},
                                              {3, 4, 3},
                                              {4, 3, 2},
                                              {12, 18, 6}})
    for (const int panel : {1, 6, 32}) {
      INFO(rows, " x ", columns, ", ", pivots, " pivots by ", panel);
      Front<T> one(rows, columns, rng), other = one;
      const std::vector<T> start = one.a;
      whole_steps(one, pivots);
      by_panels(other, pivots, panel);
      CHECK(one.a != start);
      CHECK(one.a == other.a);
      const auto left_over = [&, below = pivots * columns](const Front<T>& f) {
        return std::vector(f.bounds.begin() + below, f.bounds.end());
      };
      CHECK(left_over(one) == left_over(other));
    }
}

/// Textbook elimination by rows, whole steps, with pivots: the row where the column is largest
/// relative to the row's own size at the start, its columns given the same size by `column`, among
/// those where it is at least a tenth of the largest by the sizes that rows have at the start by
/// `common`.
struct Textbook {
  MatrixXd lu;
  std::vector<int> order;      ///< which row of the start is at each place
  double growth = 1;           ///< of rows relative to their size at the start, by `common`
  int inside = 0, across = 0;  ///< swaps within 32 rows that are one panel, and beyond

  Textbook(const MatrixXd& a, int pivots, const Eigen::VectorXd& column,
           const Eigen::VectorXd& common)
      : lu(a) {
    const int rows = static_cast<int>(a.rows());
    std::vector<double> size, start;
    const auto by_common = [&](int i, int first) {
      const auto count = a.cols() - first;
      return (lu.row(i).tail(count).transpose().cwiseAbs().cwiseProduct(common.tail(count)))
          .maxCoeff();
    };
    for (int i = 0; i < rows; ++i) {
      order.push_back(i);
      size.push_back(0);
      start.push_back(by_common(i, 0));
      for (int j = 0; j < a.cols(); ++j)
        size.back() = std::max(size.back(), std::abs(a(i, j)) * column(j));
    }
    const auto stands_out = [&](int i, int k) {
      return std::abs(lu(i, k)) / size[solve_test::at(i)];
    };
    for (int k = 0; k < pivots; ++k) {
      double most = 0;
      for (int i = k; i < rows; ++i)
        most = std::max(most, std::abs(lu(i, k)) / start[solve_test::at(i)]);
      int best = -1;
      for (int i = k; i < rows; ++i)
        if (std::abs(lu(i, k)) >= 0.1 * most * start[solve_test::at(i)] &&
            (best < 0 || stands_out(i, k) > stands_out(best, k)))
          best = i;
      inside += best > k && best / 32 == k / 32;
      across += best / 32 > k / 32;
      lu.row(k).swap(lu.row(best));
      std::swap(size[solve_test::at(k)], size[solve_test::at(best)]);
      std::swap(start[solve_test::at(k)], start[solve_test::at(best)]);
      std::swap(order[solve_test::at(k)], order[solve_test::at(best)]);
      for (int i = k + 1; i < rows; ++i) {
        if (lu(i, k) == 0) continue;
        const double l = lu(i, k) / lu(k, k);
        for (int j = k + 1; j < a.cols(); ++j) lu(i, j) -= l * lu(k, j);
        lu(i, k) = l;
      }
    }
    for (int i = 0; i < rows; ++i)
      growth = std::max(growth, by_common(i, std::min(i, pivots)) / start[solve_test::at(i)]);
  }
};

/// Rows of very different size, one entry of four 0; each column has a large entry, in any row, so
/// that many steps survive cancellation.
MatrixXd in_no_order(int rows, int columns, Rng& rng) {
  MatrixXd a(rows, columns);
  std::vector<int> place;
  for (int i = 0; i < rows; ++i) place.push_back(i);
  rng.shuffle(place);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) a(i, j) = rng.below(4) == 0 ? 0 : rng.between(-1, 1);
  for (int j = 0; j < std::min(rows, columns); ++j) a(place[solve_test::at(j)], j) += 4;
  for (int i = 0; i < rows; ++i) a.row(i) *= rng.octaves(-20, 20);
  return a;
}

/// The solver's factors of a front of these numbers, as its constructor makes them. The columns
/// that are no pivots go on to another front, which has as many rows more as it takes.
void compare_factors(int rows, int columns, int pivots, Rng& rng) {
  INFO(rows, " x ", columns, ", ", pivots, " pivots");
  const MatrixXd a = in_no_order(rows, columns, rng);
  titop::solve::Structure structure;
  std::vector<solve_test::RowEntries<double>> entries{{a.leftCols(pivots)}};
  structure.add_variable(pivots);
  if (columns == pivots) {
    structure.add_row(rows, std::vector{0});
  } else {
    structure.add_variable(columns - pivots);
    structure.add_row(rows, std::vector{0, 1});
    structure.add_row(columns - rows, std::vector{1});
    entries[0].push_back(a.rightCols(columns - pivots));
    entries.push_back({in_no_order(columns - rows, columns - pivots, rng)});
  }
  const auto plan = std::make_shared<const titop::solve::Plan>(titop::solve::plan(structure));
  const auto front = static_cast<std::size_t>(plan->front_of_row[0]);
  const titop::solve::Front& f = plan->fronts[front];
  REQUIRE(f.row_count == rows);
  REQUIRE(f.columns() == columns);
  REQUIRE(f.pivot_count == pivots);
  REQUIRE(f.children.count == 0);

  // The columns' sizes are given: how the solver finds them is a matter of scaling.cpp.
  auto scale = std::make_shared<titop::solve::ColumnScale>();
  for (int j = 0; j < plan->columns; ++j)
    scale->in_fronts.push_back(static_cast<std::int16_t>(rng.below(5) - 2));
  for (int j = 0; j < plan->unknowns; ++j)
    scale->of_unknowns.push_back(static_cast<std::int16_t>(rng.below(5) - 2));
  Eigen::VectorXd column(columns), common(columns);
  for (int j = 0; j < columns; ++j) {
    const int unknown = j < pivots ? f.first_unknown + j : plan->first[1] + j - pivots;
    column(j) = std::ldexp(1.0, scale->in_fronts[solve_test::at(f.first_column + j)]);
    common(j) = std::ldexp(1.0, scale->of_unknowns[solve_test::at(unknown)]);
  }

  const Textbook exact(a, pivots, column, common);
  CHECK(exact.inside > 0);
  CHECK(exact.across > 0);
  const titop::solve::Factors<double> factors(plan, solve_test::EntryRows<double>(entries), scale);
  CHECK(!factors.health().singular);
  const auto& made = factors.made(front);
  REQUIRE(made.lu.size() == static_cast<std::size_t>(rows * columns));
  CHECK(std::vector<int>(made.order.begin(), made.order.end()) == exact.order);
  int other = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      other += std::bit_cast<std::uint64_t>(made.lu[solve_test::at(i * columns + j)]) !=
               std::bit_cast<std::uint64_t>(exact.lu(i, j));
  CHECK(other == 0);
  CHECK(made.growth == exact.growth);
}

}  // namespace

TEST_CASE("elimination by panels: as whole steps, to the last bit") {
  compare<double>();
  compare<std::complex<double>>();
  compare<long double>();
}

TEST_CASE("factors of a front of several panels: as a textbook's whole steps, to the last bit") {
  Rng rng(12);
  for (int draw = 0; draw < 5; ++draw) {
    compare_factors(70, 70, 70, rng);
    compare_factors(73, 78, 70, rng);  // three rows remain, eight columns
    compare_factors(60, 66, 34, rng);
  }
}
