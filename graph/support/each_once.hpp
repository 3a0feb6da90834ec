#pragma once

#include <algorithm>

namespace titop::detail {

/// Sorts the list and keeps one of equal entries. O(n log n).
template <class List>
void keep_each_once(List& list) {
  std::ranges::sort(list);
  list.erase(std::ranges::unique(list).begin(), list.end());
}

}  // namespace titop::detail
