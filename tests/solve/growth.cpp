#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "sparse_system.hpp"

/// The plan alone: fronts, their largest size and the work grow linearly if nothing closes on
/// itself. Counted, not timed.

using namespace solve_test;
using titop::solve::Front;
using titop::solve::Plan;
using titop::solve::plan;
using titop_test::Rng;

namespace {

struct Count {
  double fronts = 0, largest = 0, flops = 0;
};
Count count(const Plan& p) {
  Count c;
  c.fronts = static_cast<double>(p.fronts.size());
  for (const Front& f : p.fronts) {
    const double rows = f.row_count, pivots = f.pivot_count, cols = pivots + f.border_count;
    c.largest = std::max({c.largest, rows, cols});
    c.flops += 2 * rows * pivots * cols;
  }
  return c;
}
Count count(const Links& links, int n, int size) {
  return count(plan(structure_of(links, std::vector<int>(at(n), size))));
}

}  // namespace

TEST_CASE("solver: work on chains, trees and rings is linear in their size") {
  for (const int size : {1, 6}) {
    Rng rng(1);
    const int n = 500, more = 8 * n;
    const auto two = [&](auto make) {
      return std::pair(count(make(n), n, size), count(make(more), more, size));
    };
    for (const auto& [name, counts] :
         {std::pair(std::string("chain"), two(chain)), std::pair(std::string("ring"), two(ring)),
          std::pair(std::string("tree"), two([&](int k) { return tree(k, rng); }))}) {
      const auto& [small, large] = counts;
      CAPTURE(name);
      CAPTURE(size);
      CHECK(large.fronts <= 8.1 * small.fronts);
      CHECK(large.flops <= (name == "tree" ? 12 : 8.5) * small.flops);
      if (name != "tree") CHECK(large.largest <= 5 * size);
    }
  }
}

/// Exponent of the work from n to 16 n groups.
double exponent(const Count& small, const Count& large) {
  return std::log(large.flops / small.flops) / std::log(16.0);
}

TEST_CASE("solver: work on ladders is linear, on planar grids it grows about as n^1.5") {
  for (const int size : {1, 6}) {
    CAPTURE(size);
    CHECK(exponent(count(grid(2, 200), 400, size), count(grid(2, 3200), 6400, size)) <= 1.02);
    const double planar =
        exponent(count(grid(32, 32), 1024, size), count(grid(128, 128), 16384, size));
    CHECK(planar <= 1.65);
  }
}

// A row that mentions every arm of a star travels through every front: their width grows with the
// number of arms, and so does the work per arm.
TEST_CASE("solver: a star takes one front per arm, with few rows") {
  const Plan p = plan(structure_of(star(200), std::vector<int>(200, 6)));
  CHECK(p.fronts.size() <= 200);
  for (const Front& f : p.fronts) CHECK(f.row_count <= 4 * 6);
}

TEST_CASE("solver: the subtrees of a front come right before it") {
  Rng rng(4);
  for (const auto& [links, n] : {std::pair(tree(300, rng), 300), std::pair(star(40), 40),
                                 std::pair(grid(9, 9), 81), std::pair(ring(50), 50)}) {
    const Plan p = plan(structure_of(links, std::vector<int>(at(n), 6)));
    std::vector<int> below(p.fronts.size(), 0);  // fronts, those below these included
    for (std::size_t f = 0; f < p.fronts.size(); ++f) {
      std::vector<int> children(p.list(p.fronts[f].children).begin(),
                                p.list(p.fronts[f].children).end());
      std::sort(children.begin(), children.end());
      int next = static_cast<int>(f);
      for (auto c = children.rbegin(); c != children.rend(); ++c) {
        CHECK(*c == next - 1);
        next = *c - below[at(*c)];
        below[f] += 1 + below[at(*c)];
      }
    }
  }
}

TEST_CASE("solver: every scalar is eliminated once, children before their parents") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      const System s = random_system(kind.links, kind.n, rng, 2);
      const Plan p = plan(s.structure);
      std::vector<int> eliminated(s.structure.variable_size.size(), 0);
      std::vector<int> entered(s.structure.row_size.size(), 0);
      std::vector<int> used(p.fronts.size(), 0);
      bool ordered = true;
      for (std::size_t f = 0; f < p.fronts.size(); ++f) {
        for (const int v : p.list(p.fronts[f].pivots)) ++eliminated[at(v)];
        for (const int r : p.list(p.fronts[f].rows)) ++entered[at(r)];
        for (const int c : p.list(p.fronts[f].children))
          ++used[at(c)], ordered = ordered && at(c) < f;
      }
      CAPTURE(seed);
      CAPTURE(kind.name);
      CHECK(std::count(eliminated.begin(), eliminated.end(), 1) == kind.n);
      CHECK(std::count(entered.begin(), entered.end(), 1) == kind.n);
      CHECK(std::count_if(used.begin(), used.end(), [](int n) { return n > 1; }) == 0);
      CHECK(ordered);
    }
  }
}
