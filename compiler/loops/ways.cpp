#include <algorithm>
#include <titop/compiler/loops/motion.hpp>
#include <titop/graph/linalg/index.hpp>
#include <unordered_map>
#include <utility>

/// Ways round a closed chain: the tree's, or a shorter one through ties that close chains.
namespace titop::loops {
namespace {

using linalg::at;

constexpr int kTreeWays = 16;  ///< cost of a search for a shorter way, in ways of the tree
constexpr int kNear = 40;      ///< a way of fewer edges is searched first: a bay of a ladder

}  // namespace

int Motion::tree_way(const Tie& tie) const {
  const int a = tie.target, b = tie.points.empty() ? ground_ : tie.points.begin()->first;
  const int top = meeting(a, b);
  return depth_[at(a)] + depth_[at(b)] - (top < 0 ? 0 : 2 * depth_[at(top)]);
}

void Motion::plant_shortcuts(std::vector<Tie> released, const std::vector<char>& one_way) {
  shortcut_.resize(at(ground_) + 1);
  for (const Tie& tie : ties_)
    if (tie.closes) plant_shortcut(tie, one_way);
  for (Tie& tie : released) {
    tie.length = tree_way(tie);
    plant_shortcut(tie, one_way);
  }
  // A search finds the same ways whether ties have been released or not.
  for (auto& from : shortcut_)
    std::sort(from.begin(), from.end(),
              [](const Shortcut& a, const Shortcut& b) { return a.rank < b.rank; });
}

/// Only ties of all directions: a free angle would be one more unknown.
void Motion::plant_shortcut(const Tie& tie, const std::vector<char>& one_way) {
  if (tie.S.rows() != tie.S.cols()) return;
  auto edge = edge_of(tie);
  if (!edge || one_way[at(edge->to)] || one_way[at(edge->from)] || edge->to == edge->from) return;
  if (edge->from != ground_) shortcut_[at(edge->from)].push_back({tie.rank(), reversed(*edge)});
  shortcut_[at(edge->to)].push_back({tie.rank(), std::move(*edge)});
}

std::vector<int> Motion::shorter(int a, int b, Tie::Rank rank, int length) const {
  std::unordered_map<int, int> before[2] = {{{a, a}}, {{b, b}}};  // on the way back to that end
  std::vector<int> front[2] = {{a}, {b}};
  int left = kTreeWays * length;  // edges that may be looked at
  for (int levels = 0; levels < length - 1; ++levels) {
    // Not from the ground: too many edges start there.
    const int side = b == ground_ || front[0].size() <= front[1].size() ? 0 : 1;
    std::vector<int> next;
    int met = -1;
    const auto reach = [&](int from, int to) {
      --left;
      if (met >= 0 || !before[side].try_emplace(to, from).second) return;
      next.push_back(to);
      if (before[1 - side].contains(to)) met = to;
    };
    for (const int p : front[side]) {
      if (static_cast<int>(below_[at(p)].size() + shortcut_[at(p)].size()) >= left) return {};
      if (depth_[at(p)] > 0) reach(p, up_[at(p)].from);
      for (const int q : below_[at(p)]) reach(p, q);
      for (const Shortcut& s : shortcut_[at(p)])
        if (s.rank < rank) reach(p, s.edge.from);
    }
    if (met >= 0) {
      std::vector<int> way{met};
      while (way.back() != a) way.push_back(before[0].at(way.back()));
      std::reverse(way.begin(), way.end());
      while (way.back() != b) way.push_back(before[1].at(way.back()));
      return way;
    }
    if (next.empty()) return {};
    front[side] = std::move(next);
  }
  return {};
}

Motion::Edge Motion::edge_between(int point, int next, Tie::Rank rank) const {
  if (depth_[at(point)] > 0 && up_[at(point)].from == next) return up_[at(point)];
  if (depth_[at(next)] > 0 && up_[at(next)].from == point) return reversed(up_[at(next)]);
  return std::find_if(shortcut_[at(point)].begin(), shortcut_[at(point)].end(),
                      [&](const Shortcut& s) { return s.rank < rank && s.edge.from == next; })
      ->edge;
}

std::pair<Motion::Way, Motion::Way> Motion::ways(const Tie& tie) const {
  const int a = tie.target, b = tie.points.empty() ? ground_ : tie.points.begin()->first;
  if (tie.points.size() > 1) return {up_from(a, -1), up_from(b, -1)};
  std::vector<int> way = shorter(a, b, tie.rank(), kNear);
  if (way.empty()) {
    const int top = meeting(a, b);
    if (top < 0) return {up_from(a, -1), up_from(b, -1)};
    way = shorter(a, b, tie.rank(), tie.length);
    if (way.empty()) return {up_from(a, top), up_from(b, top)};
  }
  const auto nearest = std::min_element(way.begin(), way.end(), [&](int p, int q) {
    return std::pair(p != ground_, depth_[at(p)]) < std::pair(q != ground_, depth_[at(q)]);
  });
  Way there{*nearest}, back{*nearest};
  for (auto p = way.begin(); p != nearest; ++p)
    there.edges.push_back(edge_between(*p, *(p + 1), tie.rank()));
  for (auto p = way.end() - 1; p != nearest; --p)
    back.edges.push_back(edge_between(*p, *(p - 1), tie.rank()));
  return {std::move(there), std::move(back)};
}

}  // namespace titop::loops
