#include <algorithm>
#include <map>
#include <titop/compiler/realization/reciprocity.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;

/// A term between channels: its signal and its coefficient.
struct Link {
  int signal = -1, coefficient = -1;
};
using Links = std::map<std::pair<int, int>, Link>;  // of channel, from channel

struct Finder {
  const Factored& d;
  const Graph& g = d.graph();
  Links rows = {}, wires = {};        ///< of algebraic blocks, and between blocks
  std::vector<int> said = {};         ///< per channel: the signal that an equation determines
  std::vector<char> is_outside = {};  ///< per channel: inputs alone determine it

  const Signal& signal(int s) const { return g.signals[at(s)]; }
  bool counts(const Term& t) const {
    return signal(t.signal).active && signal(t.signal).role != Signal::Role::external;
  }
  bool says_output(int channel) const {
    return said[at(channel)] >= 0 && signal(said[at(channel)]).role == Signal::Role::output;
  }

  /// False if there is no hope.
  bool take(int index) {
    const Equation& e = g.equations[at(index)];
    if (!e.active) return true;
    const bool outside =
        std::none_of(e.terms.begin(), e.terms.end(), [&](const Term& t) { return counts(t); });
    const Signal& to = signal(e.target);
    // A port of a block without channels acts on none by itself.
    if (to.channel < 0) return outside || g.nodes[at(to.node)].block->interface().channels.empty();
    if (!e.part.whole()) return false;
    if (!e.of_block) {
      if (said[at(to.channel)] >= 0) return false;
      said[at(to.channel)] = e.target, is_outside[at(to.channel)] = outside;
    }
    for (std::size_t t = 0; t < e.terms.size(); ++t)
      if (counts(e.terms[t]) && !take(index, static_cast<int>(t))) return false;
    return true;
  }

  bool take(int index, int term) {
    const Equation& e = g.equations[at(index)];
    const Signal &to = signal(e.target), &from = signal(e.terms[at(term)].signal);
    if (from.channel < 0) return false;
    if (e.of_block && (from.role != Signal::Role::input || from.node != to.node)) return false;
    const Link link{e.terms[at(term)].signal,
                    d.skeleton->joint.equation_coefficient[at(index)] + term};
    return (e.of_block ? rows : wires).emplace(std::pair(to.channel, from.channel), link).second;
  }

  /// The channel's input is 0, or determined by inputs alone. (An unobservable one is inactive,
  /// too, but moves.)
  bool rests(int channel) const {
    const Channel& c = g.channels[at(channel)];
    const int taken = c.takes == Takes::force ? c.force : c.accel;
    return signal(taken).at_rest || (said[at(channel)] == taken && is_outside[at(channel)]);
  }

  bool pair(const Links& links, bool between, ReciprocalPairs& result) const {
    for (const auto& [channels, link] : links) {
      const auto [to, from] = channels;
      if (!between && (rests(to) || rests(from))) continue;
      if (between && link.signal == said[at(from)]) {
        if (!is_outside[at(from)]) return false;
        continue;
      }
      const auto back = links.find({from, to});
      if (back == links.end()) return false;
      // An equation for a block's output exchanges cause and effect: the sign changes.
      const int sign = between && says_output(to) != says_output(from) ? -1 : 1;
      if (to <= from) result.pairs.push_back({link.coefficient, back->second.coefficient, sign});
    }
    return true;
  }
};

bool is_transposed(const solve::RowMatrix<double>& a, const solve::RowMatrix<double>& b, int sign) {
  return a.rows() == b.cols() && a.cols() == b.rows() && a == sign * b.transpose();
}

/// In rows and columns of channels, `size` of them: they come first.
bool is_symmetric(const Dynamics& d, Index size) {
  if (!d.sparse.empty()) return false;
  const auto D = d.D.topLeftCorner(size, size);
  return D == D.transpose();
}

}  // namespace

std::optional<ReciprocalPairs> reciprocity_of(const Factored& data) {
  Finder f{data};
  f.said.assign(f.g.channels.size(), -1);
  f.is_outside.assign(f.g.channels.size(), false);
  for (int e = 0; e < static_cast<int>(f.g.equations.size()); ++e)
    if (!f.take(e)) return std::nullopt;
  ReciprocalPairs result;
  if (!f.pair(f.rows, false, result) || !f.pair(f.wires, true, result)) return std::nullopt;
  for (int i = 0; i < static_cast<int>(f.g.nodes.size()); ++i) {
    const Node& node = f.g.nodes[at(i)];
    int size = 0;
    for (const ChannelSpec& c : node.block->interface().channels) size += c.size;
    if (!node.lowered && size > 0) result.blocks.emplace_back(i, size);
  }
  return result;
}

bool ReciprocalPairs::holds(const solve::Numbers& numbers) const {
  const Dynamics* seen = nullptr;  // neighbours often share theirs
  for (const auto& [node, size] : blocks) {
    const Dynamics* const d = numbers.blocks[at(node)].get();
    if (d != seen && !is_symmetric(*d, size)) return false;
    seen = d;
  }
  return std::all_of(pairs.begin(), pairs.end(), [&](const Pair& p) {
    return is_transposed(*numbers.coefficients[at(p.a)], *numbers.coefficients[at(p.b)], p.sign);
  });
}

}  // namespace titop::detail
