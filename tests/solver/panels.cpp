#include <doctest/doctest.h>

#include <complex>
#include <titop/compiler/solve/steps.hpp>
#include <vector>

#include "support/rng.hpp"

/// Elimination by panels, some steps at a time: bit by bit what whole steps give.

namespace {

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
  for (std::ptrdiff_t k = 0; k < pivots; ++k)
    for (std::ptrdiff_t i = k + 1; i < f.rows; ++i) {
      if (f.at(i, k) == T(0)) continue;
      const T l = f.at(i, k) /= f.at(k, k);
      for (std::ptrdiff_t j = k + 1; j < f.n; ++j) {
        titop::solve::subtract(1, l, &f.at(k, j), &f.at(i, j));
        f.bound(i, j) += titop::solve::size_of(l) * f.bound(k, j);
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
  for (const auto& [rows, columns, pivots] :
       {std::tuple(7, 9, 7), {20, 31, 16}, {45, 83, 40}, {40, 40, 40}, {5, 70, 1}})
    for (const int panel : {1, 6, 32}) {
      INFO(rows, " x ", columns, ", ", pivots, " pivots by ", panel);
      Front<T> one(rows, columns, rng), other = one;
      const std::vector<T> start = one.a;
      whole_steps(one, pivots);
      by_panels(other, pivots, panel);
      CHECK(one.a != start);
      CHECK(one.a == other.a);
      CHECK(one.bounds == other.bounds);
    }
}

}  // namespace

TEST_CASE("elimination by panels: as whole steps, to the last bit") {
  compare<double>();
  compare<std::complex<double>>();
  compare<long double>();
}
