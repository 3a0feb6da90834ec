#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace titop::detail {

/// Places of a graph's nodes, inputs or outputs in the order in which the user declared them; the
/// graph stores them in another order. O(n log n).
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

/// First row or column of each output or input in the declared order. O(n).
template <class List>
std::vector<int> first_as_declared(const List& list) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  std::vector<int> size(list.size()), first(list.size()), result;
  for (const auto& item : list) size[at(item.declared)] = item.size;
  int total = 0;
  for (std::size_t i = 0; i < list.size(); ++i) first[i] = total, total += size[i];
  for (const auto& item : list) result.push_back(first[at(item.declared)]);
  return result;
}

}  // namespace titop::detail
