#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace titop::detail {

/// Places of a graph's nodes, inputs or outputs in the order in which the user declared them; the
/// graph has them in the order of names. O(n log n).
template <class List>
std::vector<int> as_declared(const List& list) {
  const auto declared = [&](int i) { return list[static_cast<std::size_t>(i)].declared; };
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return declared(a) < declared(b); });
  return order;
}

}  // namespace titop::detail
