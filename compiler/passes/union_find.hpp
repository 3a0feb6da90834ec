#pragma once

#include <numeric>
#include <vector>

namespace titop::passes {

/// Disjoint sets of 0 ... n-1 with path halving; the representative is the smallest member.
class UnionFind {
 public:
  explicit UnionFind(int n) : parent_(static_cast<std::size_t>(n)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i) {
    while (up(i) != i) {
      up(i) = up(up(i));
      i = up(i);
    }
    return i;
  }
  /// False if they were joined already.
  bool unite(int a, int b) {
    a = find(a), b = find(b);
    if (a == b) return false;
    (a < b ? up(b) : up(a)) = a < b ? a : b;
    return true;
  }

 private:
  int& up(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

}  // namespace titop::passes
