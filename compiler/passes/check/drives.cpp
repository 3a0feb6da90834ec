#include <algorithm>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// Overlap of two driven parts of one channel.
bool overlap(const Equation& a, const Equation& b) {
  if (a.part.whole() || b.part.whole()) return true;
  return (a.part.rows() * b.part.rows().transpose()).cwiseAbs().maxCoeff() > linalg::kAxisRounding;
}

/// Two driven parts that share some of their directions, and not all of them.
bool oblique(const Equation& a, const Equation& b) {
  if (a.part.whole() || b.part.whole()) return false;
  const Eigen::MatrixXd &A = a.part.rows(), &B = b.part.rows();
  const Eigen::MatrixXd left = B - B * A.transpose() * A;
  return left.rowwise().norm().minCoeff() > linalg::kMatrixDigits;
}

/// The direction of b that is at right angles to a, if both are one: "(0, 0.6, 0.8)".
std::string oblique_way_out(const Equation& a, const Equation& b) {
  const Eigen::MatrixXd &A = a.part.rows(), &B = b.part.rows();
  if (A.rows() != 1 || B.rows() != 1) return "drive parts that are at right angles to each other";
  const Eigen::RowVectorXd left = (B - B * A.transpose() * A).normalized();
  const Eigen::Index first =
      left.size() == 6 && left.head(3).norm() < left.tail(3).norm() ? Eigen::Index{3} : 0;
  return fmt::format(
      "drive directions at right angles: in place of the second its part across the first, "
      "({:.6g}, {:.6g}, {:.6g})",
      left(first), left(first + 1), left(first + 2));
}

std::string free_way_out(const Graph& graph, const Channel& channel) {
  const std::string name = channel_name(graph, static_cast<int>(&channel - graph.channels.data()));
  const std::string accel = name_of(graph, channel.accel), force = name_of(graph, channel.force);
  if (graph.nodes[at(channel.node)].block->interface().channels[at(channel.spec)].name != "parent")
    return fmt::format("write {} = 0 to leave it free, or {} = 0 to lock it", force, accel);
  const std::string& node = graph.nodes[at(channel.node)].name;
  return channel.size == 6
             ? fmt::format(
                   "write mount({}, B.child(\"C1\"), T_ba) to fix it to a body B, {} = 0 to "
                   "clamp it, or {} = 0 to leave it free",
                   node, accel, force)
             : fmt::format(
                   "write {} = z.child.accel to fix it to a block z, {} = 0 to clamp it, or "
                   "{} = 0 to leave it free",
                   accel, accel, force);
}

/// Forces add up at a point; motions do not: a second one closes a chain.
std::string twice_way_out(const Graph& g, const Channel& channel, int target) {
  if (target != channel.accel) return "keep one of them; to add a force write += instead of =";
  const std::string name = channel_name(g, static_cast<int>(&channel - g.channels.data()));
  if (channel.takes == Takes::force)
    return fmt::format(
        "keep one of them, an acceleration is not summed; to join a second point here (closed "
        "chain), write weld(point, {}), which drives the other point",
        name);
  return fmt::format(
      "keep one of them, an acceleration is not summed; to hold {0} at a second body too (closed "
      "chain), give {0} a child point there and write weld({0}.child(\"C\"), site)",
      g.nodes[at(channel.node)].name);
}

void check_channel(Checker& c, const Channel& channel, const Drive& drive) {
  const Graph& g = c.graph;
  const int index = static_cast<int>(&channel - g.channels.data());
  std::vector<int> set(drive.accel.begin(), drive.accel.end());
  set.insert(set.end(), drive.force.begin(), drive.force.end());
  int rows = 0;
  bool clash = false;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Equation& a = g.equations[at(set[i])];
    rows += a.part.whole() ? channel.size : static_cast<int>(a.part.rows().rows());
    for (std::size_t j = 0; j < i; ++j) {
      const Equation& b = g.equations[at(set[j])];
      if (!overlap(a, b)) continue;
      clash = true;
      const bool same = a.target == b.target;
      if (oblique(b, a)) {
        c.add(Code::two_equations,
              fmt::format("{}{} and {}{} are both driven, and are not at right angles",
                          name_of(g, b.target), b.part.name(), name_of(g, a.target), a.part.name()),
              {line(print(g, b), written(g, b)), line(print(g, a), written(g, a))},
              oblique_way_out(b, a));
        continue;
      }
      c.add(Code::two_equations,
            same ? fmt::format("{} is driven twice", name_of(g, a.target))
                 : fmt::format("{} is driven on both sides, acceleration and force",
                               channel_name(g, index)),
            {line(print(g, b), written(g, b)), line(print(g, a), written(g, a))},
            same ? twice_way_out(g, channel, a.target)
                 : "keep one of them; the other side can be read");
    }
  }
  const bool child = channel.takes == Takes::force;
  const bool released = std::any_of(drive.added.begin(), drive.added.end(),
                                    [&](int e) { return !g.equations[at(e)].of_spec; });
  if (!clash && rows < channel.size && !child && !released) {
    const std::string subject =
        rows == 0 ? name_of(g, channel.accel)
                  : fmt::format("{} ({} of {} degrees of freedom)", name_of(g, channel.accel),
                                channel.size - rows, channel.size);
    c.add(Code::no_equation, fmt::format("{} is not driven", subject),
          {added_at(g, g.nodes[at(channel.node)])}, free_way_out(g, channel));
  }
}

/// Use of a channel's force in the forces of other points.
struct Passed {
  bool whole = false;     ///< all of it
  bool reaction = false;  ///< without the terms added to it
};

std::vector<Passed> passed_on(const Graph& g) {
  std::vector<Passed> result(g.channels.size());
  for (const Equation& e : g.equations) {
    if (e.target < 0 || g.signals[at(e.target)].quantity != Quantity::force) continue;
    for (const Term& t : e.terms) {
      const int channel = t.signal < 0 ? -1 : g.signals[at(t.signal)].channel;
      if (channel < 0 || t.signal != g.channels[at(channel)].force) continue;
      (t.of == Term::Of::reaction ? result[at(channel)].reaction : result[at(channel)].whole) =
          true;
    }
  }
  return result;
}

/// If a point moves with another, its force is that of the tie; terms added by `+=` act through the
/// reaction alone. An equation that passes on the whole force loses the added terms.
void check_added(Checker& c, const Channel& channel, const Drive& drive) {
  const Graph& g = c.graph;
  const auto says = [&](int e) { return !g.equations[at(e)].terms.empty(); };
  const auto tied = [&](int e) {
    const Equation& q = g.equations[at(e)];
    return q.part.whole() && std::any_of(q.terms.begin(), q.terms.end(), [&](const Term& t) {
             return t.signal >= 0 && g.signals[at(t.signal)].channel >= 0;
           });
  };
  const auto added = std::find_if(drive.added.begin(), drive.added.end(), says);
  const auto tie = std::find_if(drive.accel.begin(), drive.accel.end(), tied);
  if (added == drive.added.end() || tie == drive.accel.end()) return;
  const Equation &a = g.equations[at(*tie)], &b = g.equations[at(*added)];
  c.add(Code::two_equations,
        fmt::format("a force added to {} has no effect: its acceleration is driven, and the whole "
                    "force is passed on",
                    name_of(g, channel.force)),
        {line(print(g, a), written(g, a)), line(print(g, b), written(g, b))},
        "pass on the port's reaction (the force without the added terms), as mount does; or add "
        "the force at the point with which it moves");
}

void check_one_way(Checker& c) {
  const Graph& g = c.graph;
  std::vector<int> driver(g.signals.size(), -1);
  for (std::size_t i = 0; i < g.equations.size(); ++i) {
    const Equation& e = g.equations[i];
    if (e.target < 0 || g.signals[at(e.target)].channel >= 0) continue;
    int& first = driver[at(e.target)];
    if (first >= 0) {
      const Equation& b = g.equations[at(first)];
      c.add(Code::two_equations, fmt::format("{} is driven twice", name_of(g, e.target)),
            {line(print(g, b), written(g, b)), line(print(g, e), written(g, e))},
            "keep one of them, or write their sum");
    }
    first = static_cast<int>(i);
  }
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    const Signal& sig = g.signals[at(s)];
    if (sig.role == Signal::Role::input && sig.channel < 0 && driver[at(s)] < 0)
      c.add(Code::no_equation, fmt::format("{} is not driven", name_of(g, s)),
            {added_at(g, g.nodes[at(sig.node)])},
            fmt::format("write {} = ..., or {} = 0", name_of(g, s), name_of(g, s)));
  }
}

}  // namespace

void check_drives(Checker& c) {
  const Graph& g = c.graph;
  const Drives all(g);
  for (std::size_t i = 0; i < all.size(); ++i) check_channel(c, g.channels[i], all[i]);
  std::vector<Passed> passed;  // only if terms are added to a driven channel
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].added.empty() || all[i].accel.empty()) continue;
    if (passed.empty()) passed = passed_on(g);
    if (passed[i].whole && !passed[i].reaction) check_added(c, g.channels[i], all[i]);
  }
  check_one_way(c);
}

}  // namespace titop::passes
