#include <algorithm>
#include <titop/compiler/passes/lower/shared_motions.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>
#include <utility>

namespace titop::passes {

using Eigen::MatrixXd;
using linalg::at;

namespace {

using Level = Lowering::Level;
using SharedMotion = Lowering::SharedMotion;

/// Its one output is the motion.
class MotionBlock final : public Block {
 public:
  MotionBlock(const SharedMotion& motion, int size)
      : motion_(motion),
        face_{{},
              {},
              {{"out", size,
                motion.level == Level::position ? Quantity::position : Quantity::velocity}},
              {}} {}
  std::string_view type() const override { return "Motion"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override {
    const Eigen::Index n = face_.outputs[0].size;
    return std::make_shared<Dynamics>(
        Dynamics{MatrixXd(0, 0), MatrixXd(0, 0), MatrixXd(n, 0), MatrixXd(n, 0)});
  }
  bool is_algebraic() const override { return true; }
  bool has_frame() const override { return false; }
  const SharedMotion& motion() const { return motion_; }

 private:
  SharedMotion motion_;
  Interface face_;
};

/// A motion as a number: 2 channel + level.
int place(int channel, Level level) { return 2 * channel + (level == Level::rate ? 1 : 0); }

/// The ways from the points that equations read up to where they end.
struct Ways {
  static constexpr int kMost = 12;  ///< states that an equation reads one by one
  static constexpr int kUnseen = -2, kEnd = -1;

  Lowering& l;
  std::vector<int> next = std::vector<int>(l.g.channels.size(), kUnseen);
  std::vector<int> end = next, states = next;  ///< per channel: where its way ends; its own states
  std::vector<char> still = std::vector<char>(next.size(), 0);  ///< it does not move
  std::vector<int> order = {};                                  ///< channels, upper ones first
  std::vector<std::vector<int>> read = {};  ///< per equation: motions, each once
  std::vector<int> uses = std::vector<int>(2 * next.size(), 0);
  std::vector<int> length = uses;  ///< states up to the anchor
  std::vector<char> reached = std::vector<char>(uses.size(), 0), meets = reached, is_long = reached;

  int above(int motion) const {
    const int channel = next[at(motion / 2)];
    return channel < 0 ? -1 : 2 * channel + motion % 2;
  }
  bool is_anchor(int motion) const { return meets[at(motion)] || next[at(motion / 2)] < 0; }

  /// The point that this one follows; kEnd if it moves by more than that and its own states.
  int follow(int channel) {
    const MatrixXd I =
        MatrixXd::Identity(l.g.channels[at(channel)].size, l.g.channels[at(channel)].size);
    Amount own;
    l.unopened.clear();
    const auto points = l.step(own, {channel, I, I.array() != 0}, Level::position);
    states[at(channel)] = static_cast<int>(own.size());
    still[at(channel)] = own.empty() && points.empty();
    const bool of_states = std::all_of(own.begin(), own.end(), [&](const Summand& s) {
      return l.g.signals[at(s.signal)].role == Signal::Role::state;
    });
    return points.size() == 1 && of_states && l.unopened.empty() ? points.front().channel : kEnd;
  }

  /// The way up from here. A closed chain is the end of the ways that lead to it.
  void explore(int start) {
    std::vector<int> way;
    int c = start;
    for (; c >= 0 && next[at(c)] == kUnseen; c = next[at(c)]) {
      way.push_back(c);
      next[at(c)] = follow(c);
    }
    const auto round = std::find(way.begin(), way.end(), c);
    for (auto k = round; k != way.end(); ++k) next[at(*k)] = kEnd;
    for (auto k = way.rbegin(); k != way.rend(); ++k) {
      end[at(*k)] = next[at(*k)] < 0 ? *k : end[at(next[at(*k)])];
      order.push_back(*k);
    }
  }

  /// True if some way is long; only motions that the equations write themselves are known yet.
  bool any_long() const {
    std::vector<int> all(next.size(), 0);
    for (const int c : order)
      if (next[at(c)] >= 0 && (all[at(c)] = states[at(c)] + all[at(next[at(c)])]) > kMost)
        return true;
    return false;
  }

  void take(const std::vector<std::pair<int, Level>>& list) {
    std::vector<int> motions;
    for (const auto& [channel, level] : list) {
      explore(channel);
      motions.push_back(place(channel, level));
    }
    detail::keep_each_once(motions);
    if (!motions.empty()) read.push_back(std::move(motions));
  }

  /// Sets `read`: the motions in each lowered equation.
  void read_all() {
    std::vector<std::pair<int, Level>> list;
    l.readings = &list;
    const auto equation = [&](const auto& look) { list.clear(), look(), take(list); };
    for (int c = 0; c < static_cast<int>(l.drive.size()); ++c) {
      for (const int e : l.drive[at(c)].accel)
        equation([&] { l.terms(l.g.equations[at(e)].terms); });
      if (l.drive[at(c)].free > 0) equation([&] { l.force(c); });
    }
    for (const Equation& e : l.g.equations)
      if (l.g.signals[at(e.target)].channel < 0) equation([&] { l.terms(e.terms); });
    l.readings = nullptr;
  }

  /// Where ways of one equation meet; those of one end can.
  void find_meetings() {
    std::vector<int> of(uses.size(), -1);
    for (int e = 0; e < static_cast<int>(read.size()); ++e) {
      std::vector<int> ends;
      for (const int m : read[at(e)]) ends.push_back(2 * end[at(m / 2)] + m % 2);
      detail::keep_each_once(ends);
      if (ends.size() == read[at(e)].size()) continue;
      for (int m : read[at(e)]) {
        while (m >= 0 && of[at(m)] != e) of[at(m)] = e, m = above(m);
        if (m >= 0) meets[at(m)] = 1;
      }
    }
  }

  /// How often a motion is read, by equations and by motions of points below.
  void count_uses() {
    for (const auto& list : read)
      for (int m : list) {
        ++uses[at(m)];
        while (m >= 0 && !std::exchange(reached[at(m)], 1))
          if (m = above(m); m >= 0) ++uses[at(m)];
      }
  }

  std::vector<SharedMotion> shared() {
    std::vector<SharedMotion> result;
    std::vector<int> anchor(uses.size(), -1);
    const auto each = [&](int channel, const auto& visit) {
      for (const int m : {2 * channel, 2 * channel + 1})
        if (reached[at(m)] && next[at(channel)] >= 0) visit(m, above(m));
    };
    for (const int c : order)
      each(c, [&](int m, int up) {
        anchor[at(m)] = is_anchor(up) ? up : anchor[at(up)];
        length[at(m)] = states[at(c)] + (is_anchor(up) ? 0 : length[at(up)]);
      });
    for (auto c = order.rbegin(); c != order.rend(); ++c)
      each(*c, [&](int m, int up) {
        if (length[at(m)] > kMost) is_long[at(m)] = 1;
        if (is_long[at(m)] && !is_anchor(up)) is_long[at(up)] = 1;
      });
    for (const int c : order)
      each(c, [&](int m, int) {
        if (!is_long[at(m)] || uses[at(m)] < 2 || length[at(m)] == 0) return;
        const int a = anchor[at(m)] / 2;
        result.push_back({c, m % 2 ? Level::rate : Level::position, a, still[at(a)] != 0});
      });
    return result;
  }
};

}  // namespace

std::vector<SharedMotion> find_shared_motions(const Stage& stage, const Graph& g) {
  std::vector<int> channels;
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms)
      if (t.of == Term::Of::position || t.of == Term::Of::rate)
        channels.push_back(g.signals[at(t.signal)].channel);
  if (channels.empty()) return {};
  detail::keep_each_once(channels);
  Lowering l(g, stage.values, std::make_shared<const Drives>(g), stage.motions);
  Ways ways{l};
  try {
    for (const int c : channels) ways.explore(c);
    if (!ways.any_long()) return {};
    ways.read_all();
  } catch (const Error&) {
    return {};  // found again where the equations are written out
  }
  ways.find_meetings();
  ways.count_uses();
  return ways.shared();
}

int add_shared_motion(Graph& g, const SharedMotion& motion) {
  const Channel& c = g.channels[at(motion.channel)];
  const char* const level = motion.level == Level::position ? ".position" : ".rate";
  const int node =
      add_node(g, channel_name(g, motion.channel) + level,
               std::make_shared<MotionBlock>(motion, c.size), g.nodes[at(c.node)].where);
  g.nodes[at(node)].lowered = true;
  return node;
}

std::vector<SharedMotion> shared_motions_of(const Stage& stage) {
  std::vector<SharedMotion> result;
  for (std::size_t n = stage.source->nodes.size(); n < stage.graph.nodes.size(); ++n)
    if (const auto* m = dynamic_cast<const MotionBlock*>(stage.graph.nodes[n].block.get()))
      result.push_back(m->motion());
  return result;
}

// --- in equations ------------------------------------------------------------------------------

void Lowering::share(std::vector<SharedMotion> list) {
  shared = std::move(list);
  if (shared.empty()) return;
  shared_at.assign(2 * g.channels.size(), -1);
  for (std::size_t m = 0; m < shared.size(); ++m)
    shared_at[at(place(shared[m].channel, shared[m].level))] = static_cast<int>(m);
}

/// Its index, -1 if it is written out.
int Lowering::shared_motion(int channel, Level level) const {
  return shared_at.empty() || flat ? -1 : shared_at[at(place(channel, level))];
}

/// The next point up its way that has a shared motion, or its anchor; the states on the way are
/// added.
Lowering::WayPoint Lowering::up_from(const SharedMotion& motion, Amount& sum) {
  const int n = g.channels[at(motion.channel)].size;
  const MatrixXd I = MatrixXd::Identity(n, n);
  WayPoint here{motion.channel, I, I.array() != 0};
  do {
    auto points = step(sum, here, motion.level);
    astray = astray || points.size() != 1;
    if (astray) return {motion.anchor, I, I.array() != 0};
    here = std::move(points.front());
  } while (here.channel != motion.anchor && shared_motion(here.channel, motion.level) < 0);
  return here;
}

/// The motion in terms of the states on its way and of the next shared motion.
Amount Lowering::against_anchor(const SharedMotion& motion) {
  Amount sum;
  WayPoint up = up_from(motion, sum);
  if (up.channel != motion.anchor)
    sum.push_back({static_cast<int>(g.signals.size()) + shared_motion(up.channel, motion.level),
                   std::move(up.factor), std::move(up.declared)});
  return sum;
}

/// The anchor of this motion as the next point of a way that comes from its channel.
Lowering::WayPoint Lowering::at_anchor(int motion, const WayPoint& here) {
  for (std::size_t m = to_anchor.size(); m < shared.size(); ++m) {
    std::vector<int> others = std::exchange(met, {});
    Amount unused;
    WayPoint up = up_from(shared[m], unused);
    if (up.channel != shared[m].anchor) {
      const ToAnchor& rest = to_anchor[at(shared_motion(up.channel, shared[m].level))];
      up.factor = up.factor * rest.factor;
      up.declared = product(up.declared, rest.declared);
      met.insert(met.end(), rest.met.begin(), rest.met.end());
      detail::keep_each_once(met);
    }
    to_anchor.push_back({std::move(up.factor), std::move(up.declared), std::move(met)});
    met = std::move(others);
  }
  const ToAnchor& way = to_anchor[at(motion)];
  met.insert(met.end(), way.met.begin(), way.met.end());
  return {shared[at(motion)].anchor, here.factor * way.factor,
          product(here.declared, way.declared)};
}

}  // namespace titop::passes
