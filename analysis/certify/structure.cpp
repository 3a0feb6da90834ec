#include <fmt/format.h>

#include <cmath>
#include <span>
#include <titop/analysis/certify/structure.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::certification {
namespace {

using Eigen::VectorXd;
using ChannelVectors = std::vector<VectorXd>;  ///< one per channel

using linalg::at;

/// The reason why an equation of a channel is more than a connection of bodies, springs and
/// dampers; empty if it is not.
std::string beside_bodies(const Graph& g, const Equation& e, ParameterValues values) {
  const Signal& target = g.signals[at(e.target)];
  const bool force = g.channels[at(target.channel)].force == e.target;
  for (const Term& t : e.terms) {
    const Signal& s = g.signals[at(t.signal)];
    if (s.role == Signal::Role::external) continue;
    const bool motion = !passes::of_motions(g, t, values).empty();
    if (motion && force) continue;
    if (motion || s.channel < 0)
      return fmt::format("{} is driven by {}", name_of(g, e.target), name_of(g, t.signal));
    for (const Factor& f : t.factors)
      if (std::holds_alternative<Value>(f) || std::holds_alternative<Matrix>(f))
        return fmt::format("{} is driven by a gain on {}", name_of(g, e.target),
                           name_of(g, t.signal));
  }
  return "";
}

/// The equations between bodies: without the diagram's inputs, springs and dampers.
class Connections {
 public:
  Connections(const Graph& g, ParameterValues values)
      : g_(g), values_(values), drive_(g), accel_(zeros()), force_(zeros()) {
    ChannelVectors any = zeros();
    randomize(0, size(), any);
    settle([&](std::size_t c) {
      const Drive& d = drive_[c];
      return replace(accel_[c], d.N().transpose() * (d.N() * any[c]) + sum(d.accel, c));
    });
  }

  std::size_t size() const { return g_.channels.size(); }

  /// Total work of the wrenches under the motions imposed on channels [first, end), over the sum of
  /// magnitudes; motions are random.
  double work(std::size_t first, std::size_t end) {
    ChannelVectors any = zeros();
    randomize(first, end, any);
    force_ = reaction_ = zeros();
    settle([&](std::size_t c) {
      const Drive& d = drive_[c];
      const VectorXd added = sum(d.added, c);
      const Eigen::MatrixXd N = d.N();
      const bool moved =
          replace(force_[c], any[c] + N.transpose() * (N * (sum(d.force, c) + added - any[c])));
      return replace(reaction_[c], force_[c] - added) || moved;
    });
    double all = 0, magnitudes = 0;
    for (std::size_t c = 0; c < size(); ++c) {
      const VectorXd each = force_[c].cwiseProduct(accel_[c]);
      all += is_outward(g_, static_cast<int>(c)) ? -each.sum() : each.sum();
      magnitudes += each.cwiseAbs().sum();
    }
    return magnitudes > 0 ? std::abs(all) / magnitudes : 0;
  }

 private:
  ChannelVectors zeros() const {
    ChannelVectors list;
    for (const Channel& c : g_.channels) list.push_back(VectorXd::Zero(c.size));
    return list;
  }

  static void randomize(std::size_t first, std::size_t end, ChannelVectors& list) {
    detail::SteadyRandom random;
    for (std::size_t c = first; c < end; ++c)
      for (double& x : list[c]) x = random.unit();
  }

  static bool replace(VectorXd& old, const VectorXd& now) {
    const bool moved = old != now;
    old = now;
    return moved;
  }

  /// Until all equations are satisfied: they follow one another, so that the number of rounds is
  /// that of the longest chain. `update` returns whether anything moved.
  template <class Update>
  void settle(const Update& update) const {
    bool moved = true;
    for (std::size_t round = 0; moved && round <= 2 * size(); ++round) {
      moved = false;
      for (std::size_t c = 0; c < size(); ++c) moved = update(c) || moved;
    }
  }

  /// Right-hand sides of these equations on channel c.
  VectorXd sum(std::span<const int> equations, std::size_t c) const {
    VectorXd result = VectorXd::Zero(g_.channels[c].size);
    for (const int e : equations) {
      const Equation& equation = g_.equations[at(e)];
      for (const Term& t : equation.terms) {
        const Signal& s = g_.signals[at(t.signal)];
        if (s.channel < 0 || t.of == Term::Of::position || t.of == Term::Of::rate) continue;
        const VectorXd x = coefficient(g_, t, values_) * of(t, s.channel);
        result += equation.part.whole() ? x : VectorXd(equation.part.rows().transpose() * x);
      }
    }
    return result;
  }

  const VectorXd& of(const Term& t, int channel) const {
    if (t.of == Term::Of::reaction) return reaction_[at(channel)];
    return (g_.channels[at(channel)].accel == t.signal ? accel_ : force_)[at(channel)];
  }

  const Graph& g_;
  ParameterValues values_;
  Drives drive_;
  ChannelVectors accel_, force_, reaction_;
};

/// The first channel whose motion is imposed and whose wrench is not returned, by bisection: work
/// is linear in the wrenches.
std::string taken_for_nothing(const Graph& g, Connections& all) {
  std::size_t first = 0, end = all.size();
  if (all.work(first, end) <= linalg::kAxisRounding) return "";
  while (end - first > 1) {
    const std::size_t middle = (first + end) / 2;
    (all.work(first, middle) > linalg::kAxisRounding ? end : first) = middle;
  }
  return fmt::format("{} takes the motion of a point and returns no wrench there",
                     channel_name(g, static_cast<int>(first)));
}

}  // namespace

std::string why_no_structure(const Graph& g, ParameterValues values) {
  for (const Equation& e : g.equations) {
    const Signal& target = g.signals[at(e.target)];
    if (target.channel >= 0) {
      if (std::string found = beside_bodies(g, e, values); !found.empty()) return found;
    } else if (!g.nodes[at(target.node)].block->interface().channels.empty()) {
      return name_of(g, e.target) + " is driven, a one-way port of a body";
    }
  }
  if (std::string found = passes::why_no_springs(g, values); !found.empty()) return found;
  Connections all(g, values);
  return taken_for_nothing(g, all);
}

bool has_poles_of_bodies_only(const Graph& g) {
  const auto is_body = [&](int node) {
    return !g.nodes[at(node)].block->interface().channels.empty();
  };
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    if (g.nodes[at(i)].state >= 0 && !is_body(i) && g.nodes[at(i)].block->type() != "Integrator")
      return false;
  for (const Equation& e : g.equations) {
    if (const Node& node = g.nodes[at(g.signals[at(e.target)].node)];
        node.block->type() != "Integrator")
      continue;
    for (const Term& t : e.terms)
      if (const Signal& s = g.signals[at(t.signal)];
          s.role != Signal::Role::external && !is_body(s.node))
        return false;  // a loop of integrators may have any poles
  }
  return true;
}

}  // namespace titop::certification
