#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace titop::detail {

/// Places of a graph's nodes, inputs or outputs in the order in which the user declared them; the
/// graph has them in an order of its own. O(n log n).
template <class List>
std::vector<int> as_declared(const List& list) {
  std::vector<std::pair<int, int>> places;
  places.reserve(list.size());
  for (const auto& item : list) places.emplace_back(item.declared, static_cast<int>(places.size()));
  std::sort(places.begin(), places.end());
  std::vector<int> order;
  order.reserve(places.size());
  for (const auto& [declared, place] : places) order.push_back(place);
  return order;
}

}  // namespace titop::detail
