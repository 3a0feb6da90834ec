#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <titop/compiler/solve/blame.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::solve {
namespace {

using linalg::at;

/// Declared: may the channel's output depend on its input at once?
bool has_direct(const Graph& g, const Channel& c, const Dynamics& m) {
  const Signal& gives = g.signals[at(c.takes == Takes::force ? c.accel : c.force)];
  const Signal& takes = g.signals[at(c.takes == Takes::force ? c.force : c.accel)];
  if (!m.sparse.empty())
    return std::any_of(m.sparse.begin(), m.sparse.end(), [&](const Gains& s) {
      return s.row == gives.first && s.column == takes.first;
    });
  return g.nodes[at(c.node)]
      .block->feedthrough()
      .block(gives.first, takes.first, c.size, c.size)
      .any();
}

/// Rank of the channel's own direct term after scaling its rows and columns.
int direct_rank(const Graph& g, const Channel& c, const Dynamics& m) {
  const Signal& gives = g.signals[at(c.takes == Takes::force ? c.accel : c.force)];
  const Signal& takes = g.signals[at(c.takes == Takes::force ? c.force : c.accel)];
  Eigen::MatrixXd D = m.direct(gives.first, takes.first, c.size, c.size);
  // Translations and rotations have units of their own: compare with the diagonal.
  const Eigen::VectorXd size = D.diagonal().cwiseAbs().cwiseSqrt();
  for (Eigen::Index i = 0; i < D.rows(); ++i)
    for (Eigen::Index j = 0; j < D.cols(); ++j)
      D(i, j) = size(i) > 0 && size(j) > 0 ? D(i, j) / (size(i) * size(j)) : 0;
  Eigen::FullPivLU<Eigen::MatrixXd> lu(D);
  lu.setThreshold(linalg::kAxisRounding);
  return static_cast<int>(lu.rank());
}

/// The user's equations for the signal; those of a pass if there are none.
std::vector<std::string> written(const Stage& stage, int signal) {
  std::vector<std::string> lines;
  for (const Graph* g : {&*stage.source, &stage.graph}) {
    for (const Equation& written_so : g->equations) {
      if (written_so.target != signal) continue;
      Equation e = written_so;
      if (e.terms.empty()) e.accumulate = false;  // a joint adds 0 to an undriven force
      lines.push_back(fmt::format("{:<50} {}", print(*g, e), to_string(e.where)));
    }
    if (!lines.empty()) return lines;
  }
  return {name_of(stage.graph, signal)};
}

Mistake improper(const Stage& stage, const Channel& c, int rank) {
  const Graph& g = stage.graph;
  const int index = static_cast<int>(&c - g.channels.data());
  const bool child = c.takes == Takes::force;
  const int driven = child ? c.accel : c.force, other = child ? c.force : c.accel;
  const Node& node = g.nodes[at(c.node)];
  Mistake m{Code::improper, {}, {}, {}};
  m.message = fmt::format("{} is imposed, and {} would need derivatives of it", name_of(g, driven),
                          name_of(g, other));
  m.details = written(stage, driven);
  if (const auto cause = node.block->why_singular(c.spec, stage.values)) {
    m.details.push_back(fmt::format("{} {}", node.name, cause->why));
    m.hint = cause->way_out;
    return m;
  }
  m.details.push_back(
      fmt::format("the direct term of {} has rank {} of {}", channel_name(g, index), rank, c.size));
  m.hint = child ? fmt::format(
                       "leave the degrees of freedom free that {} cannot be driven in (keep "
                       "more modes or residual vectors there), or impose {} instead",
                       channel_name(g, index), name_of(g, other))
                 : fmt::format("give {} mass in every direction, or impose {} instead", node.name,
                               name_of(g, other));
  return m;
}

/// The equations among these rows, and those on the ports of the blocks among them.
std::vector<std::string> equations_around(const Stage& stage, const std::vector<int>& rows) {
  const Graph& g = stage.graph;
  std::set<int> equations;
  std::set<int> outputs, nodes;
  for (const int r : rows) {
    const Row& row = stage.rows[at(r)];
    if (row.equation >= 0) equations.insert(row.equation);
    if (row.equation < 0) outputs.insert(row.output), nodes.insert(row.node);
  }
  for (int e = 0; e < static_cast<int>(g.equations.size()); ++e) {
    const Signal& target = g.signals[at(g.equations[at(e)].target)];
    if (outputs.contains(g.equations[at(e)].target) ||
        (target.role == Signal::Role::input && nodes.contains(target.node)))
      equations.insert(e);
  }
  std::vector<std::string> result;
  std::set<int> targets;
  for (const int e : equations) {
    const int target = g.equations[at(e)].target;
    if (!targets.insert(target).second) continue;
    const std::vector<std::string> lines = written(stage, target);
    result.insert(result.end(), lines.begin(), lines.end());
  }
  constexpr std::size_t kMost = 6;
  if (result.size() <= kMost) return result;
  const std::size_t more = result.size() - kMost;
  result.resize(kMost);
  result.push_back(fmt::format("and {} more", more));
  return result;
}

/// The port that a row is for.
int port_of(const Stage& stage, int row) {
  const Row& r = stage.rows[at(row)];
  return r.equation >= 0 ? stage.graph.equations[at(r.equation)].target : r.output;
}

}  // namespace

Mistake massless(const Stage& stage, const std::vector<int>& rows) {
  const Graph& g = stage.graph;
  Mistake m{Code::improper, {}, {}, {}};
  for (const int r : rows) {
    const int channel = g.signals[at(port_of(stage, r))].channel;
    const bool inverted =
        std::any_of(stage.inversions.begin(), stage.inversions.end(),
                    [&](const Inversion& i) { return i.channel == channel && channel >= 0; });
    if (!inverted) continue;
    const Channel& c = g.channels[at(channel)];
    const auto cause = g.nodes[at(c.node)].block->why_singular(c.spec, stage.values);
    if (!cause) continue;
    m.details = written(stage, c.takes == Takes::force ? c.accel : c.force);
    m.details.push_back(fmt::format("{} {}", g.nodes[at(c.node)].name, cause->why));
    m.hint = cause->way_out;
    return m;
  }
  m.details = equations_around(stage, rows);
  m.hint =
      "give the points between these equations mass, or a block of their loop a state or another "
      "gain; or output positions instead of accelerations";
  return m;
}

Mistake blame(const Stage& stage, const std::vector<std::shared_ptr<const Dynamics>>& blocks,
              const std::vector<int>& rows, const std::vector<int>& inputs) {
  const Graph& g = stage.graph;
  std::vector<int> ports;
  for (const int r : rows) ports.push_back(port_of(stage, r));
  const auto concerns = [&](int signal) {
    return std::find(ports.begin(), ports.end(), signal) != ports.end();
  };
  // First the channels that their block could invert by itself with other numbers; then those that
  // depend on the mounted bodies (a hinge's own axis, a child point of a rigid body).
  for (const bool by_itself : {true, false})
    for (const Inversion& inversion : stage.inversions) {
      const Channel& c = g.channels[at(inversion.channel)];
      const Dynamics& own = *blocks[at(c.node)];
      if (!(concerns(c.force) || concerns(c.accel)) || has_direct(g, c, own) != by_itself) continue;
      const int rank = direct_rank(g, c, own);
      if (rank < c.size) return improper(stage, c, rank);
    }
  Mistake m{Code::ill_posed, {}, {}, {}};
  std::string names, driven;
  for (const int s : ports) names += (names.empty() ? "" : ", ") + name_of(g, s);
  for (const int i : inputs) driven += (driven.empty() ? "" : ", ") + g.inputs[at(i)].name;
  m.message = fmt::format("the algebraic loop through {} has no unique solution", names);
  m.details = equations_around(stage, rows);
  m.details.push_back(
      inputs.empty()
          ? "these equations do not determine the ports: one of them follows from the others"
          : fmt::format("these equations are consistent only if a combination of {} is 0", driven));
  m.details.push_back("without any one of these ports the others would be determined");
  m.hint = fmt::format(
      "break the direct feedthrough around {}: give one block of the loop a state, or "
      "change a gain",
      ports.empty() ? "it" : name_of(g, ports.front()));
  return m;
}

Mistake overflow(const Stage& stage, const JointSystem& joint, const Health& health) {
  std::string names;
  for (const int v : health.singular_variables)
    if (const int s = joint.variables[at(v)]; s >= 0)
      names += (names.empty() ? "" : ", ") + name_of(stage.graph, s);
  return {Code::not_finite,
          fmt::format("numbers overflow at {}", names.empty() ? "a sum of many terms" : names),
          {},
          "take other units, or smaller gains: products along the equations must stay below 1e308"};
}

}  // namespace titop::solve
