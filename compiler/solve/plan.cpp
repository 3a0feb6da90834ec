#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <titop/compiler/solve/dissection.hpp>
#include <titop/compiler/solve/plan.hpp>
#include <titop/graph/linalg/index.hpp>
#include <tuple>

namespace titop::solve {
namespace {

using linalg::at;

/// Live row sets: original row groups first, then the rows that remain of fronts. A variable's list
/// of sets may contain sets that are no longer live; `live` counts the others. Every front replaces
/// at least one set of each border variable by one, so no list outgrows its first size; its
/// capacity is 1.5 times that size, otherwise every new set would need a search for sets to drop (a
/// hub has very many).
class Merging {
 public:
  explicit Merging(Plan& plan) : p_(plan), s_(plan.structure) {
    const auto sets = s_.row_size.size(), variables = s_.variable_size.size();
    begin_.assign(variables + 1, 0);
    for (const int v : s_.variables) ++begin_[at(v) + 1];
    for (std::size_t v = 0; v < variables; ++v) begin_[v + 1] += begin_[v] + begin_[v + 1] / 2;
    sets_.resize(at(begin_.back()));
    used_.assign(variables, 0);
    for (int r = 0; r < static_cast<int>(sets); ++r)
      for (const int v : s_.row(r)) sets_[at(begin_[at(v)] + used_[at(v)]++)] = r;
    live_ = used_;
    dead_.assign(sets, 0);
    count_ = s_.row_size;
    front_of_.assign(sets, -1);
    gone_.assign(variables, 0);
    stamp_.assign(variables, 0);
  }

  bool gone(int v) const { return gone_[at(v)]; }
  int live(int v) const { return live_[at(v)]; }

  /// Size of the front that eliminating v would need: its columns, then its rows.
  std::pair<int, int> cost(int v) {
    int columns = 0, rows = 0;
    for (const int w : front_variables(v)) columns += s_.variable_size[at(w)];
    for (const int r : sets_of(v)) rows += count_[at(r)];
    return {columns, rows};
  }

  /// Takes v out: one front from all rows that mention it. Returns its border.
  std::span<const int> merge(int v);

 private:
  std::span<const int> variables_of(int set) const {
    const int front = front_of_[at(set)];
    return front < 0 ? s_.row(set) : p_.list(p_.fronts[at(front)].border);
  }

  /// The live sets of v; forgets the dead ones.
  std::span<const int> sets_of(int v) {
    int* const first = sets_.data() + begin_[at(v)];
    int* const last =
        std::remove_if(first, first + used_[at(v)], [&](int r) { return dead_[at(r)] != 0; });
    used_[at(v)] = static_cast<int>(last - first);
    return {first, at(used_[at(v)])};
  }

  /// All variables of the rows that mention v, unsorted.
  const std::vector<int>& front_variables(int v) {
    ++now_;
    found_.clear();
    for (const int r : sets_of(v))
      for (const int w : variables_of(r))
        if (stamp_[at(w)] != now_) stamp_[at(w)] = now_, found_.push_back(w);
    return found_;
  }

  void add_set(int v, int set) {
    if (begin_[at(v)] + used_[at(v)] == begin_[at(v) + 1]) sets_of(v);
    sets_[at(begin_[at(v)] + used_[at(v)]++)] = set;
    ++live_[at(v)];
  }

  template <class Keep>
  Front::Range list(Keep keep) {
    Front::Range range{static_cast<int>(p_.lists.size()), 0};
    keep();
    range.count = static_cast<int>(p_.lists.size()) - range.begin;
    return range;
  }

  Plan& p_;
  const Structure& s_;
  std::vector<int> begin_, sets_, used_, live_;  ///< variable -> row sets
  std::vector<int> count_, front_of_;  ///< set -> scalars, and the front that left it over or -1
  std::vector<char> dead_, gone_;
  std::vector<int> stamp_, found_, merged_;
  int now_ = 0;
};

std::span<const int> Merging::merge(int v) {
  const auto sets = sets_of(v);
  merged_.assign(sets.begin(), sets.end());
  std::vector<int>& all = found_;
  front_variables(v);
  std::sort(all.begin(), all.end());
  Front f;
  f.rows = list([&] {
    for (const int r : merged_)
      if (front_of_[at(r)] < 0) p_.lists.push_back(r);
  });
  f.children = list([&] {
    for (const int r : merged_)
      if (front_of_[at(r)] >= 0) p_.lists.push_back(front_of_[at(r)]);
  });
  for (const int r : merged_) {
    f.row_count += count_[at(r)];
    dead_[at(r)] = 1;
    for (const int w : variables_of(r)) --live_[at(w)];
  }
  const auto size = [&](int w) { return s_.variable_size[at(w)]; };
  f.pivots = list([&] {
    for (const int w : all)
      if (live_[at(w)] == 0) p_.lists.push_back(w), f.pivot_count += size(w), gone_[at(w)] = 1;
  });
  // Vectors before the scalars along one of their directions: the angle of a hinge taken first cost
  // a satellite six digits of A.
  std::sort(p_.lists.begin() + f.pivots.begin, p_.lists.end(),
            [&](int a, int b) { return size(a) != size(b) ? size(a) > size(b) : a < b; });
  f.border = list([&] {
    for (const int w : all)
      if (live_[at(w)] > 0) p_.lists.push_back(w), f.border_count += size(w);
  });
  const int index = static_cast<int>(p_.fronts.size());
  p_.fronts.push_back(f);
  const auto border = p_.list(f.border);
  if (f.left_over() <= 0) return border;
  const int set = static_cast<int>(count_.size());
  count_.push_back(f.left_over());
  front_of_.push_back(index);
  dead_.push_back(0);
  for (const int w : border) add_set(w, set);
  return border;
}

/// Beyond this many row sets a variable's cost is not counted but set to that number; it is counted
/// once there are fewer.
constexpr int kMany = 64;

/// `when`: variables with a smaller number go first; empty: no order. Of equal costs the first
/// variable is taken, not the last one found: branch by branch would be quicker, but starts
/// branches at their junctions, which cost a chain of sixteen booms two digits.
void eliminate_all(Plan& p, const std::vector<int>& when) {
  Merging m(p);
  using Cost = std::tuple<int, int, int>;    // when, columns, rows
  std::map<Cost, std::vector<int>> waiting;  // of each cost a heap, the first variable on top
  std::vector<Cost> cost(p.structure.variable_size.size());
  const auto push = [&](int v, bool exact) {
    const auto [columns, rows] = exact || m.live(v) <= kMany ? m.cost(v) : std::pair(m.live(v), 0);
    cost[at(v)] = {when.empty() ? 0 : when[at(v)], columns, rows};
    std::vector<int>& heap = waiting[cost[at(v)]];
    heap.push_back(v);
    std::push_heap(heap.begin(), heap.end(), std::greater<>());
  };
  for (int v = 0; v < static_cast<int>(cost.size()); ++v) push(v, false);
  while (!waiting.empty()) {
    const auto least = waiting.begin();
    const Cost c = least->first;
    std::vector<int>& heap = least->second;
    std::pop_heap(heap.begin(), heap.end(), std::greater<>());
    const int v = heap.back();
    heap.pop_back();
    if (heap.empty()) waiting.erase(least);
    if (m.gone(v) || c != cost[at(v)]) continue;
    if (std::get<2>(c) == 0 && m.live(v) > 0) {  // not counted yet
      push(v, true);
      continue;
    }
    for (const int w : m.merge(v)) push(w, false);
  }
}

/// Every front's children, those that begin with later rows first.
std::vector<int> last_rows_first(const Plan& p) {
  std::vector<int> children = p.lists, begins(p.fronts.size());
  for (std::size_t i = 0; i < p.fronts.size(); ++i) {
    const Front& f = p.fronts[i];
    int& begin = begins[i] = std::numeric_limits<int>::max();
    for (const int r : p.list(f.rows)) begin = std::min(begin, r);
    for (const int c : p.list(f.children)) begin = std::min(begin, begins[at(c)]);
    const auto own = std::span(children).subspan(at(f.children.begin), at(f.children.count));
    std::stable_sort(own.begin(), own.end(),
                     [&](int a, int b) { return begins[at(a)] > begins[at(b)]; });
  }
  return children;
}

/// Postorder: every front right after its descendants, with its lists, so that a front's children
/// are near in memory, in any order of elimination. Rows are in the depth-first order of their
/// nodes: from the last to the first, the fronts of a tree go through memory in one direction. The
/// operations in a front, and so every number, stay the same.
void in_postorder(Plan& p) {
  const int count = static_cast<int>(p.fronts.size());
  std::vector<char> below(at(count), 0);
  for (const Front& f : p.fronts)
    for (const int c : p.list(f.children)) below[at(c)] = 1;
  std::vector<Front> fronts;
  std::vector<int> lists, place(at(count));
  fronts.reserve(at(count));
  lists.reserve(p.lists.size());
  const auto moved = [&](Front::Range range) {
    const auto old = p.list(range);
    lists.insert(lists.end(), old.begin(), old.end());
    return Front::Range{static_cast<int>(lists.size()) - range.count, range.count};
  };
  const std::vector<int> children = last_rows_first(p);
  std::vector<std::pair<int, int>> open;  // a front, and how many of its children are done
  for (int root = 0; root < count; ++root) {
    if (below[at(root)]) continue;
    open.emplace_back(root, 0);
    while (!open.empty()) {
      auto& [front, done] = open.back();
      Front f = p.fronts[at(front)];
      if (done < f.children.count) {
        open.emplace_back(children[at(f.children.begin + done++)], 0);
        continue;
      }
      place[at(front)] = static_cast<int>(fronts.size());
      f.rows = moved(f.rows);
      f.children = moved(f.children);
      for (int& c : std::span(lists).last(at(f.children.count))) c = place[at(c)];
      f.pivots = moved(f.pivots);
      f.border = moved(f.border);
      fronts.push_back(f);
      open.pop_back();
    }
  }
  p.fronts = std::move(fronts);
  p.lists = std::move(lists);
}

/// Places of all pivots, entries and remaining rows.
void place(Plan& p) {
  p.first.assign(p.structure.variable_size.size(), 0);
  p.front_of_row.assign(p.structure.row_size.size(), -1);
  p.entry_column.resize(p.structure.variables.size());
  p.parent_column.assign(p.lists.size(), 0);
  int row = 0;
  for (const int size : p.structure.row_size) p.row_first.push_back(row), row += size;
  std::vector<int> column(p.first.size(), 0);
  for (int i = 0; i < static_cast<int>(p.fronts.size()); ++i) {
    Front& f = p.fronts[at(i)];
    f.first_unknown = p.unknowns;
    f.first_carried = p.carried;
    f.first_column = p.columns;
    p.columns += f.columns();
    p.entries += f.entries();
    p.unknowns += f.pivot_count;
    p.carried += std::max(0, f.left_over());
    int next = 0;
    for (const auto range : {f.pivots, f.border})
      for (const int v : p.list(range))
        column[at(v)] = next, next += p.structure.variable_size[at(v)];
    for (const int v : p.list(f.pivots)) p.first[at(v)] = f.first_unknown + column[at(v)];
    for (const int r : p.list(f.rows)) {
      p.front_of_row[at(r)] = i;
      for (int e = p.structure.row_begin[at(r)]; e < p.structure.row_begin[at(r) + 1]; ++e)
        p.entry_column[at(e)] = column[at(p.structure.variables[at(e)])];
    }
    for (const int child : p.list(f.children)) {
      Front& c = p.fronts[at(child)];
      c.parent = i;
      for (int k = c.border.begin; k < c.border.begin + c.border.count; ++k)
        p.parent_column[at(k)] = column[at(p.lists[at(k)])];
    }
  }
}

}  // namespace

void Structure::add_variable(int size, int unit) {
  variable_size.push_back(size);
  variable_unit.push_back(unit);
}

void Structure::add_row(int size, std::span<const int> over) {
  row_size.push_back(size);
  variables.insert(variables.end(), over.begin(), over.end());
  const auto own = variables.begin() + row_begin.back();
  std::sort(own, variables.end());
  variables.erase(std::unique(own, variables.end()), variables.end());
  row_begin.push_back(static_cast<int>(variables.size()));
}

namespace {

double work(const Plan& p) {
  double flops = 0;
  for (const Front& f : p.fronts) flops += 2.0 * f.row_count * f.pivot_count * f.columns();
  return flops;
}

bool wide(const Front& f) { return f.columns() > 128; }

}  // namespace

Plan plan(Structure structure) {
  Plan result;
  result.structure = std::move(structure);
  eliminate_all(result, {});
  if (std::any_of(result.fronts.begin(), result.fronts.end(), wide)) {
    Plan cut;
    cut.structure = result.structure;
    eliminate_all(cut, dissection(cut.structure));
    if (work(cut) < work(result)) result = std::move(cut);
  }
  in_postorder(result);
  place(result);
  return result;
}

}  // namespace titop::solve
