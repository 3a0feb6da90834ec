#include <doctest/doctest.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/max_cardinality_matching.hpp>
#include <boost/pending/disjoint_sets.hpp>
#include <titop/compiler/passes/matching.hpp>
#include <titop/compiler/passes/union_find.hpp>

#include "support/rng.hpp"

/// The library's own matching and disjoint sets against Boost's.

using namespace titop::passes;
using titop_test::Rng;

namespace {

/// Random row vertices over as many columns, each entry with this probability; vertices of two
/// sizes, of which only equal ones may be matched.
Incidence random_incidence(int n, double share, Rng& rng) {
  Incidence inc;
  for (int i = 0; i < n; ++i) {
    inc.signal_of.push_back(i);
    inc.row_of_vertex.push_back(i);
    inc.row_size.push_back(rng.below(4) == 0 ? 3 : 1);
    inc.col_size.push_back(rng.below(4) == 0 ? 3 : 1);
    for (int j = 0; j < n; ++j)
      if (rng.between(0, 1) < share) inc.mentioned.push_back(j);
    inc.begin.push_back(static_cast<int>(inc.mentioned.size()));
  }
  return inc;
}

int boost_matched(const Incidence& inc) {
  const int n = inc.row_vertices();
  boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS> g(
      static_cast<std::size_t>(2 * n));
  for (int i = 0; i < n; ++i)
    for (const int j : inc.cols(i))
      if (inc.row_size[static_cast<std::size_t>(i)] == inc.col_size[static_cast<std::size_t>(j)])
        boost::add_edge(static_cast<std::size_t>(i), static_cast<std::size_t>(n + j), g);
  std::vector<std::size_t> mate(static_cast<std::size_t>(2 * n));
  boost::edmonds_maximum_cardinality_matching(g, mate.data());
  return static_cast<int>(boost::matching_size(g, mate.data()));
}

}  // namespace

TEST_CASE("matching: as many pairs as Boost's, of 0 to 40 rows, from sparse to dense") {
  Rng rng(11);
  for (int n = 0; n <= 40; ++n)
    for (const double share : {0.0, 0.05, 0.15, 0.5, 1.0}) {
      CAPTURE(n);
      CAPTURE(share);
      const Incidence inc = random_incidence(n, share, rng);
      const Matching m = maximum_matching({}, inc);
      const int matched = n - m.missing() / 2;
      CHECK(matched == boost_matched(inc));
      int pairs = 0;
      for (int i = 0; i < n; ++i) {
        const int j = m.row_to_col[static_cast<std::size_t>(i)];
        if (j < 0) continue;
        ++pairs;
        CHECK(m.col_to_row[static_cast<std::size_t>(j)] == i);
        CHECK(std::ranges::count(inc.cols(i), j) == 1);
        CHECK(inc.row_size[static_cast<std::size_t>(i)] ==
              inc.col_size[static_cast<std::size_t>(j)]);
      }
      CHECK(pairs == matched);
    }
}

TEST_CASE("disjoint sets: those of Boost, named by their smallest members") {
  Rng rng(12);
  for (int n = 1; n <= 40; ++n) {
    UnionFind ours(n);
    boost::disjoint_sets_with_storage<> theirs(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) theirs.make_set(k);
    for (int k = 0; k < n; ++k) {
      const int a = rng.below(n), b = rng.below(n);
      const bool apart = theirs.find_set(a) != theirs.find_set(b);
      theirs.union_set(a, b);
      CHECK(ours.unite(a, b) == apart);
    }
    for (int a = 0; a < n; ++a) {
      int smallest = 0;
      while (theirs.find_set(smallest) != theirs.find_set(a)) ++smallest;
      CHECK(ours.find(a) == smallest);
    }
  }
}
