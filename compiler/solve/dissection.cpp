#include <algorithm>
#include <titop/compiler/solve/dissection.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

constexpr std::size_t kFew = 24;  ///< parts that are not cut any further

class Dissection {
 public:
  explicit Dissection(const Structure& s) : s_(s) {
    const std::size_t n = s.variable_size.size();
    begin_.assign(n + 1, 0);
    for (const int v : s.variables) ++begin_[at(v) + 1];
    for (std::size_t v = 0; v < n; ++v) begin_[v + 1] += begin_[v];
    rows_.resize(s.variables.size());
    std::vector<int> used(begin_.begin(), begin_.end() - 1);
    for (int r = 0; r < static_cast<int>(s.row_size.size()); ++r)
      for (const int v : s.row(r)) rows_[at(used[at(v)]++)] = r;
    part_.assign(n, 0);
    level_.assign(n, -1);
    depth_.assign(n, 0);
  }

  std::vector<int> operator()() {
    std::vector<int> all(part_.size());
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
    std::vector<std::pair<std::vector<int>, int>> todo;  // a part, and how often it was cut
    todo.emplace_back(std::move(all), 0);
    while (!todo.empty()) {
      const auto [part, cuts] = std::move(todo.back());
      todo.pop_back();
      for (const int v : part) depth_[at(v)] = cuts;
      if (part.size() > kFew)
        for (auto& half : cut(part)) todo.emplace_back(std::move(half), cuts + 1);
    }
    const int deepest = *std::max_element(depth_.begin(), depth_.end());
    for (int& d : depth_) d = deepest - d;
    return depth_;
  }

 private:
  /// The part without its separator, as two halves; its components if it is not connected.
  std::vector<std::vector<int>> cut(const std::vector<int>& part) {
    const int now = ++parts_;
    for (const int v : part) part_[at(v)] = now, level_[at(v)] = -1;
    std::vector<int> reached = search(part.front(), now);
    if (reached.size() < part.size()) return components(part, now);
    for (const int v : reached) level_[at(v)] = -1;
    reached = search(reached.back(), now);  // from far out the levels are many and small
    const int middle = level_[at(reached[reached.size() / 2])];
    std::vector<std::vector<int>> halves(2);
    for (const int v : reached)
      if (level_[at(v)] != middle) halves[level_[at(v)] > middle].push_back(v);
    if (halves[0].empty() || halves[1].empty()) return {};  // all variables are coupled
    return halves;
  }

  std::vector<std::vector<int>> components(const std::vector<int>& part, int now) {
    for (const int v : part) level_[at(v)] = -1;
    std::vector<std::vector<int>> result;
    for (const int v : part)
      if (level_[at(v)] < 0) result.push_back(search(v, now));
    return result;
  }

  /// Breadth first within the part: returns the reached vertices, in order; notes their levels.
  std::vector<int> search(int start, int now) {
    std::vector<int> reached{start};
    level_[at(start)] = 0;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const int v = reached[i];
      for (int k = begin_[at(v)]; k < begin_[at(v) + 1]; ++k)
        for (const int w : s_.row(rows_[at(k)]))
          if (part_[at(w)] == now && level_[at(w)] < 0)
            level_[at(w)] = level_[at(v)] + 1, reached.push_back(w);
    }
    return reached;
  }

  const Structure& s_;
  std::vector<int> begin_, rows_;  ///< variable -> rows
  std::vector<int> part_, level_, depth_;
  int parts_ = 0;
};

}  // namespace

std::vector<int> dissection(const Structure& structure) {
  if (structure.variable_size.empty()) return {};
  return Dissection(structure)();
}

}  // namespace titop::solve
