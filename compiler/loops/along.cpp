#include <deque>
#include <set>
#include <titop/compiler/loops/along.hpp>
#include <titop/graph/linalg/index.hpp>
#include <unordered_map>
#include <utility>

namespace titop::loops {
namespace {

using linalg::at;

using Lists = std::vector<std::vector<int>>;

struct Walk {
  Lists columns, with;   ///< per chain: columns that others have too; per column: chains
  Lists through, users;  ///< per chain: those that its loop contains; those whose loops contain it
  std::vector<int> unopened, waiting;       ///< per chain: how many of its columns, of `through`
  std::vector<char> opened;                 ///< per column
  std::vector<char> met, done;              ///< per chain; met: begun, at least
  std::set<std::pair<int, int>> near = {};  ///< unopened columns, chain: if some are open
  std::deque<int> free = {};                ///< chains that open nothing and wait for nothing
  std::vector<int> result = {};

  explicit Walk(const std::vector<Closing>& closings)
      : columns(closings.size()),
        through(closings.size()),
        users(closings.size()),
        met(closings.size(), 0),
        done(closings.size(), 0) {
    std::map<FormColumn, std::vector<int>> all;
    std::unordered_map<int, int> of_equation;
    for (int c = 0; c < static_cast<int>(closings.size()); ++c) {
      of_equation[closings[at(c)].tie->equation] = c;
      for (const auto& [column, matrix] : closings[at(c)].form) all[column].push_back(c);
    }
    for (auto& [column, chains] : all) {
      if (chains.size() == 1) continue;
      for (const int c : chains) columns[at(c)].push_back(static_cast<int>(with.size()));
      with.push_back(std::move(chains));
    }
    for (int c = 0; c < static_cast<int>(closings.size()); ++c)
      for (const int e : closings[at(c)].equations)
        if (const auto found = of_equation.find(e);
            found != of_equation.end() && found->second != c)
          through[at(c)].push_back(found->second), users[at(found->second)].push_back(c);
    opened.assign(with.size(), 0);
    for (const auto& own : columns) unopened.push_back(static_cast<int>(own.size()));
    for (const auto& own : through) waiting.push_back(static_cast<int>(own.size()));
  }

  void look(int c) {
    if (!done[at(c)] && unopened[at(c)] == 0 && waiting[at(c)] == 0) free.push_back(c);
  }
  void open(int column) {
    for (const int c : with[at(column)]) {
      near.erase({unopened[at(c)]--, c});
      if (done[at(c)]) continue;
      near.emplace(unopened[at(c)], c);
      look(c);
    }
  }
  void decide(int c) {
    if (std::exchange(done[at(c)], 1)) return;
    met[at(c)] = 1;
    result.push_back(c);
    near.erase({unopened[at(c)], c});
    for (const int column : columns[at(c)])
      if (!std::exchange(opened[at(column)], 1)) open(column);
    for (const int user : users[at(c)]) --waiting[at(user)], look(user);
  }

  /// Decides the chains that this one's loop contains, and then this one.
  void reach(int goal) {
    std::vector<std::pair<int, std::size_t>> stack{{goal, 0}};
    met[at(goal)] = 1;
    while (!stack.empty()) {
      auto& [c, next] = stack.back();
      while (next < through[at(c)].size() && met[at(through[at(c)][next])]) ++next;
      if (next < through[at(c)].size()) {
        const int before = through[at(c)][next];
        met[at(before)] = 1;
        stack.emplace_back(before, 0);
        continue;
      }
      decide(c);
      stack.pop_back();
      for (; !free.empty(); free.pop_front()) decide(free.front());
    }
  }
};

}  // namespace

std::vector<int> along(const std::vector<Closing>& closings) {
  Walk walk(closings);
  for (int start = 0; start < static_cast<int>(closings.size()); ++start) {
    if (!walk.done[at(start)]) walk.reach(start);
    while (!walk.near.empty()) walk.reach(walk.near.begin()->second);
  }
  return std::move(walk.result);
}

}  // namespace titop::loops
