#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <titop/graph/linalg/index.hpp>
#include <utility>
#include <vector>

namespace titop::passes {

/// A directed graph on numbered nodes: the arrows from each, ascending, without repetition.
class Arrows {
 public:
  /// O(pairs + count), and a sort of the arrows of a node that are not in order.
  Arrows(const std::vector<std::pair<int, int>>& pairs, std::size_t count)
      : Arrows(count + 1, pairs.size()) {
    for (const auto& [from, to] : pairs) ++begin_[linalg::at(from) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (const auto& [from, to] : pairs) to_[linalg::at(next[linalg::at(from)]++)] = to;
    int end = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto first = to_.begin() + begin_[i], last = to_.begin() + next[i];
      std::sort(first, last);
      begin_[i] = end;
      end = static_cast<int>(std::unique_copy(first, last, to_.begin() + end) - to_.begin());
    }
    begin_[count] = end;
    to_.resize(linalg::at(end));
  }

  /// All arrows reversed. O(arrows + count).
  Arrows reversed() const {
    Arrows result(begin_.size(), to_.size());
    for (const int t : to_) ++result.begin_[linalg::at(t) + 1];
    std::partial_sum(result.begin_.begin(), result.begin_.end(), result.begin_.begin());
    std::vector<int> next(result.begin_.begin(), result.begin_.end() - 1);
    for (int i = 0; i < count(); ++i)
      for (const int t : from(i)) result.to_[linalg::at(next[linalg::at(t)]++)] = i;
    return result;
  }

  std::span<const int> from(int i) const {
    const int* const b = begin_.data() + i;
    return {to_.data() + b[0], to_.data() + b[1]};
  }
  int count() const { return static_cast<int>(begin_.size()) - 1; }
  std::size_t arrows() const { return to_.size(); }

 private:
  Arrows(std::size_t begins, std::size_t arrows) : begin_(begins, 0), to_(arrows) {}

  std::vector<int> begin_, to_;
};

}  // namespace titop::passes
