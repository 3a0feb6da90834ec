#include <algorithm>
#include <numeric>
#include <queue>
#include <titop/compiler/diagram/fold.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::diagram {
namespace {

using linalg::at;

/// The blocks as a forest: the parent of a block is the one whose acceleration drives it (of a
/// mounted body, its parent body); of a block that nothing moves, the first block, by name, that it
/// reads.
class Forest {
 public:
  Forest(const Graph& g, const std::vector<int>& rank) : g_(g), parent_(g.nodes.size(), -1) {
    for (const ParentLink link : {ParentLink::moved, ParentLink::moved_inverted, ParentLink::read})
      for (const auto& [target, from] : edges(link, rank))
        if (parent_[at(target)] < 0 && !hangs_on(from, target)) parent_[at(target)] = from;
  }
  const std::vector<int>& parents() const { return parent_; }

 private:
  using ChildParent = std::pair<int, int>;  ///< child, parent
  enum class ParentLink { moved, moved_inverted, read, none };

  /// A force on a body does not make its source the parent.
  ParentLink link_of(const Signal& target) const {
    if (target.channel < 0) return ParentLink::read;
    if (target.quantity != Quantity::acceleration) return ParentLink::none;
    return g_.channels[at(target.channel)].takes == Takes::accel ? ParentLink::moved
                                                                 : ParentLink::moved_inverted;
  }

  std::vector<ChildParent> edges(ParentLink link, const std::vector<int>& rank) const {
    std::vector<ChildParent> list;
    for (const Equation& e : g_.equations) {
      if (e.target < 0) continue;
      const Signal& to = g_.signals[at(e.target)];
      if (to.node < 0 || link_of(to) != link) continue;
      for (const Term& t : e.terms) {
        const int from = t.signal < 0 ? -1 : g_.signals[at(t.signal)].node;
        if (from >= 0 && from != to.node) list.emplace_back(to.node, from);
      }
    }
    std::sort(list.begin(), list.end(), [&](const ChildParent& a, const ChildParent& b) {
      return std::pair(rank[at(a.first)], rank[at(a.second)]) <
             std::pair(rank[at(b.first)], rank[at(b.second)]);
    });
    return list;
  }

  bool hangs_on(int node, int other) const {
    for (; node >= 0; node = parent_[at(node)])
      if (node == other) return true;
    return false;
  }

  const Graph& g_;
  std::vector<int> parent_;
};

constexpr std::size_t kSiblings = 8;  ///< boxes below one block: more make the picture too wide

/// Opens subtrees from the roots down, as long as there is room.
class Folding {
 public:
  Folding(const Graph& g, int most) : most_(at(most)), rank_(g.nodes.size()) {
    std::vector<int> order(g.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return natural_compare(g.nodes[at(a)].name, g.nodes[at(b)].name) < 0;
    });
    for (std::size_t i = 0; i < order.size(); ++i) rank_[at(order[i])] = static_cast<int>(i);
    parent_ = Forest(g, rank_).parents();
    children_.resize(parent_.size());
    for (const int i : order)
      (parent_[at(i)] < 0 ? roots_ : children_[at(parent_[at(i)])]).push_back(i);
    find_sizes();
  }

  Fold run() {
    Fold f;
    f.box_of.assign(parent_.size(), -1);
    std::vector<std::vector<int>> closed;  // boxes by their topmost blocks
    std::size_t shown = 0;
    const auto larger = [&](int a, int b) {
      return size_[at(a)] != size_[at(b)] ? size_[at(a)] < size_[at(b)]
                                          : rank_[at(a)] > rank_[at(b)];
    };
    std::priority_queue<int, std::vector<int>, decltype(larger)> subtrees(larger);
    const auto open = [&](std::vector<int> list) {
      std::stable_sort(list.begin(), list.end(), [&](int a, int b) { return larger(b, a); });
      const std::size_t room = std::min(kSiblings, most_ > shown ? most_ - shown : 0);
      const std::size_t take = list.size() <= room ? list.size() : room > 0 ? room - 1 : 0;
      for (std::size_t i = 0; i < take; ++i) subtrees.push(list[i]);
      shown += take;
      if (take == list.size()) return;
      closed.emplace_back(list.begin() + static_cast<std::ptrdiff_t>(take), list.end());
      ++shown;
    };
    open(roots_);
    while (!subtrees.empty()) {
      const int top = subtrees.top();
      subtrees.pop();
      if (size_[at(top)] == 1) continue;
      if (shown < most_)
        open(children_[at(top)]);  // the block itself stays
      else
        closed.push_back({top});
    }
    for (const auto& tops : closed) add_box(f, tops);
    std::sort(f.boxes.begin(), f.boxes.end(), [&](const Fold::Box& a, const Fold::Box& b) {
      return rank_[at(a.nodes.front())] < rank_[at(b.nodes.front())];
    });
    for (std::size_t b = 0; b < f.boxes.size(); ++b)
      for (const int i : f.boxes[b].nodes) f.box_of[at(i)] = static_cast<int>(b);
    return f;
  }

 private:
  /// Blocks of each subtree, without recursion: chains may be long.
  void find_sizes() {
    size_.assign(parent_.size(), 1);
    std::vector<int> down = roots_;
    for (std::size_t i = 0; i < down.size(); ++i)
      down.insert(down.end(), children_[at(down[i])].begin(), children_[at(down[i])].end());
    for (auto i = down.rbegin(); i != down.rend(); ++i)
      if (parent_[at(*i)] >= 0) size_[at(parent_[at(*i)])] += size_[at(*i)];
  }

  void add_box(Fold& f, const std::vector<int>& tops) const {
    Fold::Box box{tops, tops};
    for (std::size_t i = 0; i < box.nodes.size(); ++i) {
      const auto& below = children_[at(box.nodes[i])];
      box.nodes.insert(box.nodes.end(), below.begin(), below.end());
    }
    const auto by_rank = [&](int a, int b) { return rank_[at(a)] < rank_[at(b)]; };
    std::sort(box.nodes.begin(), box.nodes.end(), by_rank);
    std::sort(box.tops.begin(), box.tops.end(), by_rank);
    if (box.nodes.size() > 1) f.boxes.push_back(std::move(box));
  }

  std::size_t most_;
  std::vector<int> rank_, parent_, roots_, size_;
  std::vector<std::vector<int>> children_;
};

}  // namespace

Fold fold(const Graph& graph, int most) {
  if (most <= 0 || graph.nodes.size() <= at(most))
    return {{}, std::vector<int>(graph.nodes.size(), -1)};
  return Folding(graph, most).run();
}

}  // namespace titop::diagram
