#include <algorithm>
#include <functional>
#include <queue>
#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Live row sets: original row groups first, then the rows that fronts leave over.
struct Merging {
  const Structure& s;
  std::vector<std::vector<int>> vars;     ///< of each row set
  std::vector<int> count;                 ///< scalars of rows in each set
  std::vector<int> front_of;              ///< front that left this set over, -1 for originals
  std::vector<std::vector<int>> sets_of;  ///< variable -> live row sets
  std::vector<char> gone;                 ///< variables eliminated
  std::vector<int> stamp;
  int now = 0;

  explicit Merging(const Structure& structure)
      : s(structure),
        vars(structure.variables),
        count(structure.row_size),
        front_of(structure.row_size.size(), -1),
        sets_of(structure.variable_size.size()),
        gone(structure.variable_size.size(), 0),
        stamp(structure.variable_size.size(), 0) {
    for (int r = 0; r < static_cast<int>(vars.size()); ++r)
      for (const int v : vars[at(r)]) sets_of[at(v)].push_back(r);
  }

  /// All variables of the rows that mention v.
  std::vector<int> front_variables(int v) {
    ++now;
    std::vector<int> all;
    for (const int r : sets_of[at(v)])
      for (const int w : vars[at(r)])
        if (stamp[at(w)] != now) stamp[at(w)] = now, all.push_back(w);
    return all;
  }

  /// Size of the front that eliminating v would need: its columns, then its rows.
  std::pair<int, int> cost(int v) {
    int cols = 0, rows = 0;
    for (const int w : front_variables(v)) cols += s.variable_size[at(w)];
    for (const int r : sets_of[at(v)]) rows += count[at(r)];
    return {cols, rows};
  }
};

/// Takes v out: one front from all rows that mention it.
Front merge(Merging& m, int v, int index, std::vector<int>& touched) {
  Front front;
  const std::vector<int> sets = m.sets_of[at(v)];
  std::vector<int> all = m.front_variables(v);
  std::sort(all.begin(), all.end());
  for (const int r : sets) {
    if (m.front_of[at(r)] < 0)
      front.rows.push_back(r);
    else
      front.children.push_back(m.front_of[at(r)]);
    front.row_count += m.count[at(r)];
    for (const int w : m.vars[at(r)]) {
      auto& list = m.sets_of[at(w)];
      list.erase(std::find(list.begin(), list.end(), r));
    }
    m.vars[at(r)].clear();
  }
  for (const int w : all) {
    const bool here_only = m.sets_of[at(w)].empty();
    (here_only ? front.pivots : front.border).push_back(w);
    (here_only ? front.pivot_count : front.border_count) += m.s.variable_size[at(w)];
    if (here_only) m.gone[at(w)] = 1;
  }
  if (front.row_count > front.pivot_count) {
    const int set = static_cast<int>(m.vars.size());
    m.vars.push_back(front.border);
    m.count.push_back(front.row_count - front.pivot_count);
    m.front_of.push_back(index);
    for (const int w : front.border) m.sets_of[at(w)].push_back(set);
  }
  touched = front.border;
  return front;
}

}  // namespace

Plan plan(Structure structure) {
  Plan result;
  result.structure = std::move(structure);
  for (const int size : result.structure.variable_size) {
    result.first.push_back(result.unknowns);
    result.unknowns += size;
  }
  Merging m(result.structure);
  using Entry = std::pair<std::pair<int, int>, int>;  // cost, variable
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<std::pair<int, int>> cost(m.gone.size());
  const auto push = [&](int v) {
    cost[at(v)] = m.cost(v);
    queue.push({cost[at(v)], v});
  };
  for (int v = 0; v < static_cast<int>(m.gone.size()); ++v) push(v);
  std::vector<int> touched;
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (m.gone[at(v)] || c != cost[at(v)]) continue;
    result.fronts.push_back(merge(m, v, static_cast<int>(result.fronts.size()), touched));
    for (const int w : touched) push(w);
  }
  return result;
}

}  // namespace titop::solve
