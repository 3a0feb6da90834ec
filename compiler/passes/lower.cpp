#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop::passes {
namespace {

using Eigen::MatrixXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// --- names in natural order -------------------------------------------------------------------

template <class List>
std::vector<int> sorted_by_name(const List& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return natural_compare(list[at(a)].name, list[at(b)].name) < 0; });
  return order;
}

/// The same graph with nodes, inputs and outputs in natural order of their names, so that nothing
/// after this depends on the order in which the user wrote them.
Graph by_name(const Graph& g) {
  Graph out;
  out.name = g.name;
  out.parameters = g.parameters;
  std::vector<int> signal(g.signals.size(), -1);
  for (const int i : sorted_by_name(g.nodes)) {
    const Node& node = g.nodes[at(i)];
    const int added = add_node(out, node.name, node.block, node.where);
    out.nodes[at(added)].declared = node.declared;
    const int count = end_signal(g, i) - node.first_signal;
    for (int k = 0; k < count; ++k)
      signal[at(node.first_signal + k)] = out.nodes[at(added)].first_signal + k;
  }
  for (const int i : sorted_by_name(g.inputs)) {
    const Input& input = g.inputs[at(i)];
    signal[at(input.signal)] = add_input(out, input.name, input.size, input.where);
    out.inputs.back().declared = input.declared;
  }
  const auto renamed = [&](std::vector<Term> terms) {
    for (Term& t : terms) t.signal = signal[at(t.signal)];
    return terms;
  };
  for (const Equation& e : g.equations) {
    out.equations.push_back(e);
    out.equations.back().target = signal[at(e.target)];
    out.equations.back().terms = renamed(e.terms);
  }
  for (const int i : sorted_by_name(g.outputs)) {
    out.outputs.push_back(g.outputs[at(i)]);
    out.outputs.back().terms = renamed(g.outputs[at(i)].terms);
  }
  return out;
}

// --- terms as one numeric coefficient each ----------------------------------------------------

/// A signal with its coefficient and declared structure.
struct Part1 {
  int signal;
  MatrixXd c;
  Pattern p;
};
using Sum1 = std::vector<Part1>;

bool less(const Part1& a, const Part1& b) {
  if (a.signal != b.signal) return a.signal < b.signal;
  return std::lexicographical_compare(a.c.data(), a.c.data() + a.c.size(), b.c.data(),
                                      b.c.data() + b.c.size());
}

Pattern product(const MatrixXd& m, const Pattern& p) {
  return ((m.array() != 0).matrix().cast<int>() * p.cast<int>()).array() > 0;
}

Sum1 times(const MatrixXd& m, Sum1 sum) {
  for (Part1& t : sum) t.c = m * t.c, t.p = product(m, t.p);
  return sum;
}

void append(Sum1& sum, Sum1 more) {
  for (Part1& t : more) sum.push_back(std::move(t));
}

/// One term per signal, in canonical order: the sum does not depend on how it was written.
std::vector<Term> merged(Sum1 sum) {
  std::sort(sum.begin(), sum.end(), less);
  std::vector<Term> terms;
  for (std::size_t i = 0; i < sum.size();) {
    Part1 total = sum[i];
    for (++i; i < sum.size() && sum[i].signal == total.signal; ++i) {
      total.c += sum[i].c;
      total.p = total.p.array() || sum[i].p.array();
    }
    Term term{.signal = total.signal};
    term.factors.emplace_back(Matrix{std::make_shared<const MatrixXd>(std::move(total.c)),
                                     std::make_shared<const Pattern>(std::move(total.p))});
    terms.push_back(std::move(term));
  }
  return terms;
}

struct Lowering {
  const Graph& g;
  ParameterValues values;
  std::shared_ptr<const std::vector<Drive>> all_drives;
  const std::vector<Drive>& drive = *all_drives;
  std::vector<char> visiting;  ///< channels whose position is being written out
  std::vector<int> met = {};   ///< parameters met since it was last cleared
  int asked = -1;              ///< node whose matrices are at hand
  std::shared_ptr<const Dynamics> at_hand = {};
  std::vector<Mistake> mistakes = {};
  std::vector<RigidMotion> motions;
  std::set<RigidMotion> missing = {};  ///< motions that have no Integrator yet

  enum class Level { position, rate };

  Lowering(const Graph& graph, ParameterValues v, std::shared_ptr<const std::vector<Drive>> d,
           std::vector<RigidMotion> m)
      : g(graph),
        values(v),
        all_drives(std::move(d)),
        visiting(graph.channels.size(), 0),
        motions(std::move(m)) {}

  /// What an equation or output of the lowered graph amounts to.
  Sum1 amount(const Origin& origin);
  void meet(const std::vector<Value>& list) {
    for (const Value& v : list)
      if (v.is_parameter()) met.push_back(v.index());
  }
  MatrixXd coefficient_of(const Term& t);

  /// What one equation or output amounts to; its mistakes are kept, with the line it stands on.
  template <class F>
  Sum1 collect(const std::source_location& where, F amount);
  Sum1 terms(const std::vector<Term>& list);
  Sum1 force(int channel);
  Sum1 algebraic(int output);
  Sum1 twin(int channel, Level level);
  Sum1 body_twin(const Channel& c, const Kinematics& k, Level level);
  Sum1 own_motion(int channel) const;
  Sum1 integrated(Sum1 sum, Level level);
  Sum1 added(int channel, const std::vector<int>& equations);
};

/// A motion that no state holds: stands for the integral of the acceleration until `integrated`.
Sum1 Lowering::own_motion(int channel) const {
  const Channel& c = g.channels[at(channel)];
  const MatrixXd I = MatrixXd::Identity(c.size, c.size);
  return {{c.accel, I, I.array() != 0}};
}

/// Accelerations in a twin become the outputs of their Integrators; those that are missing are
/// noted.
Sum1 Lowering::integrated(Sum1 sum, Level level) {
  Sum1 result;
  for (Part1& p : sum) {
    const Signal& s = g.signals[at(p.signal)];
    if (s.role == Signal::Role::state) {
      result.push_back(std::move(p));
      continue;
    }
    const int step = s.size == 6 ? 3 : s.size;
    for (int first = 0; first < s.size; first += step) {
      if (!p.p.middleCols(first, step).any()) continue;
      const RigidMotion wanted{p.signal,
                               s.size != 6  ? RigidMotion::Half::whole
                               : first == 0 ? RigidMotion::Half::linear
                                            : RigidMotion::Half::angular,
                               level == Level::position, -1};
      const auto found = std::find_if(motions.begin(), motions.end(), [&](const RigidMotion& m) {
        return m.signal == wanted.signal && m.half == wanted.half && m.twice == wanted.twice;
      });
      if (found == motions.end())
        missing.insert(wanted);
      else
        result.push_back({g.nodes[at(found->node)].first_signal + 1, p.c.middleCols(first, step),
                          p.p.middleCols(first, step)});
    }
  }
  return result;
}

template <class F>
Sum1 Lowering::collect(const std::source_location& where, F amount) {
  try {
    return amount();
  } catch (const Error& error) {
    std::fill(visiting.begin(), visiting.end(), 0);
    for (Mistake m : error.mistakes()) {
      m.details.push_back("asked for at " + to_string(where));
      mistakes.push_back(std::move(m));
    }
    return {};
  }
}

/// What these equations add up to on their channel, in the channel's own space.
Sum1 Lowering::added(int channel, const std::vector<int>& equations) {
  const int n = g.channels[at(channel)].size;
  Sum1 sum;
  for (const int e : equations) {
    const Part& part = g.equations[at(e)].part;
    append(sum, times(part.whole() ? MatrixXd::Identity(n, n) : MatrixXd(part.rows.transpose()),
                      terms(g.equations[at(e)].terms)));
  }
  return sum;
}

Sum1 Lowering::terms(const std::vector<Term>& list) {
  Sum1 sum;
  for (const Term& t : list) {
    const MatrixXd c = coefficient_of(t);
    if (!c.allFinite())
      throw Error(Code::not_finite, fmt::format("the coefficient of {} is not finite", print(g, t)),
                  "look at its gains and parameters");
    const int channel = g.signals[at(t.signal)].channel;
    if (t.of == Term::Of::position || t.of == Term::Of::rate) {
      const Level level = t.of == Term::Of::rate ? Level::rate : Level::position;
      append(sum, integrated(times(c, twin(channel, level)), level));
      continue;
    }
    sum.push_back({t.signal, c, structure(g, t)});
    if (t.of == Term::Of::reaction)
      append(sum, times(-c, added(channel, drive[at(channel)].added)));
  }
  return sum;
}

/// The position or rate of a channel in terms of states and of motions that no state holds: the
/// twin of the equation that drives its acceleration, or the block's own kinematics from the
/// parent's position.
Sum1 Lowering::twin(int channel, Level level) {
  const Channel& c = g.channels[at(channel)];
  const Drive& d = drive[at(channel)];
  const bool back = visiting[at(channel)];  // round a closed chain: the motion of all of it
  if (back || (!d.accel.empty() && d.N.rows() > 0)) return own_motion(channel);
  visiting[at(channel)] = 1;
  Sum1 sum;
  if (!d.accel.empty()) {
    for (const int e : d.accel) {
      const Equation& equation = g.equations[at(e)];
      const MatrixXd embed = equation.part.whole() ? MatrixXd::Identity(c.size, c.size)
                                                   : MatrixXd(equation.part.rows.transpose());
      for (const Term& t : equation.terms) {
        const Signal& s = g.signals[at(t.signal)];
        if (s.channel < 0 || s.quantity != Quantity::acceleration || t.of != Term::Of::signal) {
          visiting[at(channel)] = 0;
          return own_motion(channel);  // prescribed
        }
        append(sum, times(embed * coefficient_of(t), twin(s.channel, level)));
      }
    }
  } else if (const auto k = g.nodes[at(c.node)].block->kinematics(values)) {
    meet(g.nodes[at(c.node)].block->values());
    sum = body_twin(c, *k, level);
  } else {
    sum = own_motion(channel);
  }
  visiting[at(channel)] = 0;
  return sum;
}

Sum1 Lowering::body_twin(const Channel& c, const Kinematics& k, Level level) {
  const Node& node = g.nodes[at(c.node)];
  const auto deformation = [&](int spec, double sign) {
    MatrixXd Phi = sign * k.Phi[at(spec)];
    if (level == Level::rate) Phi = Phi * node.block->dynamics(values)->A;
    Pattern pattern = Phi.array() != 0;
    return Sum1{{node.state, std::move(Phi), std::move(pattern)}};
  };
  if (c.spec != k.reference) {
    Sum1 sum = times(k.tau[at(c.spec)], twin(node.first_channel + k.reference, level));
    if (node.state >= 0) append(sum, deformation(c.spec, 1));
    return sum;
  }
  for (int spec = 0; spec < static_cast<int>(k.tau.size()); ++spec) {
    const int other = node.first_channel + spec;
    if (spec == k.reference || drive[at(other)].accel.empty()) continue;
    const linalg::Inverse inverse = k.tau[at(spec)].rows() == k.tau[at(spec)].cols()
                                        ? linalg::inverse(k.tau[at(spec)])
                                        : linalg::Inverse{};
    if (inverse.rcond == 0) continue;
    Sum1 sum = twin(other, level);
    if (node.state >= 0) append(sum, deformation(spec, -1));
    return times(inverse.matrix, std::move(sum));
  }
  return own_motion(node.first_channel + c.spec);
}

MatrixXd Lowering::coefficient_of(const Term& t) {
  for (const Factor& f : t.factors)
    if (const auto* k = std::get_if<Value>(&f))
      meet({*k});
    else if (const auto* T = std::get_if<Rotation>(&f))
      meet(T->values());
  return coefficient(g, t, values);
}

// --- equations --------------------------------------------------------------------------------

Sum1 Lowering::force(int channel) {
  const Drive& d = drive[at(channel)];
  std::vector<int> all = d.force;
  all.insert(all.end(), d.added.begin(), d.added.end());
  Sum1 sum = added(channel, all);
  return d.N.rows() == g.channels[at(channel)].size ? sum : times(d.N, std::move(sum));
}

/// out = D in.
Sum1 Lowering::algebraic(int output) {
  const Signal& y = g.signals[at(output)];
  const Node& node = g.nodes[at(y.node)];
  meet(node.block->values());
  if (asked != y.node) at_hand = node.block->dynamics(values);
  asked = y.node;
  const auto d = at_hand;
  Sum1 sum;
  if (!d->sparse.empty()) {
    for (const Gains& part : d->gains_of_row(y.first))
      sum.push_back({input_signal(g, y.node, part.column), part.gain,
                     Pattern::Constant(part.gain.rows(), part.gain.cols(), true)});
    return sum;
  }
  const Pattern pattern = node.block->feedthrough();
  for (int i = node.first_signal; i < end_signal(g, y.node); ++i)
    if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input)
      sum.push_back({i, d->D.block(y.first, u.first, y.size, u.size),
                     pattern.block(y.first, u.first, y.size, u.size)});
  return sum;
}

Sum1 Lowering::amount(const Origin& o) {
  switch (o.of) {
    case Origin::Of::accel:
    case Origin::Of::one_way: return terms(g.equations[at(o.index)].terms);
    case Origin::Of::released: return {};
    case Origin::Of::force: return force(o.index);
    case Origin::Of::algebraic: return algebraic(o.index);
    case Origin::Of::output: return terms(g.outputs[at(o.index)].terms);
  }
  return {};
}

/// The lowered equations, one after the other, each with its origin.
struct Lowered {
  Lowering& l;
  std::vector<Equation> equations = {};
  std::vector<Origin> origins = {};

  std::vector<Term> terms(Origin origin, const std::source_location& where) {
    l.met.clear();
    std::vector<Term> result = merged(l.collect(where, [&] { return l.amount(origin); }));
    std::sort(l.met.begin(), l.met.end());
    l.met.erase(std::unique(l.met.begin(), l.met.end()), l.met.end());
    origin.parameters = l.met;
    origins.push_back(std::move(origin));
    return result;
  }

  void equation(Origin origin, int target, Part part, const std::source_location& where) {
    std::vector<Term> list = terms(std::move(origin), where);
    equations.push_back({.target = target,
                         .part = std::move(part),
                         .accumulate = false,
                         .terms = std::move(list),
                         .where = where});
  }

  void channel(int index) {
    const Channel& c = l.g.channels[at(index)];
    const Drive& d = l.drive[at(index)];
    for (const int e : d.accel)
      equation({Origin::Of::accel, e}, c.accel, l.g.equations[at(e)].part,
               l.g.equations[at(e)].where);
    if (d.N.rows() == 0) return;
    const std::vector<int>& first = d.force.empty() ? d.added : d.force;
    equation({Origin::Of::force, index}, c.force,
             d.N.rows() == c.size ? Part{} : Part{d.N, ".free"},
             first.empty() ? l.g.nodes[at(c.node)].where : l.g.equations[at(first.front())].where);
  }

  void one_way() {
    std::vector<int> list;
    for (int e = 0; e < static_cast<int>(l.g.equations.size()); ++e)
      if (l.g.signals[at(l.g.equations[at(e)].target)].channel < 0) list.push_back(e);
    std::sort(list.begin(), list.end(), [&](int a, int b) {
      return l.g.equations[at(a)].target < l.g.equations[at(b)].target;
    });
    for (const int e : list)
      equation({Origin::Of::one_way, e}, l.g.equations[at(e)].target, {},
               l.g.equations[at(e)].where);
  }

  void algebraic(int node) {
    const Node& n = l.g.nodes[at(node)];
    for (int o = n.first_signal; o < end_signal(l.g, node); ++o)
      if (l.g.signals[at(o)].role == Signal::Role::output) {
        equation({Origin::Of::algebraic, o}, o, {}, n.where);
        equations.back().of_block = true;
      }
  }
};

Graph without_equations(const Graph& g) {
  return {.name = g.name,
          .nodes = g.nodes,
          .channels = g.channels,
          .signals = g.signals,
          .equations = {},
          .inputs = g.inputs,
          .outputs = g.outputs,
          .parameters = g.parameters,
          .mistakes = {}};
}

}  // namespace

namespace {

/// "hub.parent.angular_rate"
std::string name_of(const Graph& g, const RigidMotion& m) {
  const std::string half = m.half == RigidMotion::Half::linear    ? "linear_"
                           : m.half == RigidMotion::Half::angular ? "angular_"
                                                                  : "";
  return channel_name(g, g.signals[at(m.signal)].channel) + "." + half +
         (m.twice ? "position" : "rate");
}

/// Integrators of the acceleration, once or twice, as a user would write them.
void add_integrators(Graph& g, const std::set<RigidMotion>& missing,
                     std::vector<RigidMotion>& motions) {
  std::set<RigidMotion> all = missing;
  for (RigidMotion m : missing)
    if (m.twice) {
      m.twice = false;
      const bool there = std::any_of(motions.begin(), motions.end(), [&](const RigidMotion& o) {
        return o.signal == m.signal && o.half == m.half && !o.twice;
      });
      if (!there) all.insert(m);
    }
  const auto find = [&](const RigidMotion& m, bool twice) {
    return std::find_if(motions.begin(), motions.end(),
                        [&](const RigidMotion& o) {
                          return o.signal == m.signal && o.half == m.half && o.twice == twice;
                        })
        ->node;
  };
  for (const bool twice : {false, true})
    for (RigidMotion m : all) {
      if (m.twice != twice) continue;
      const int size = g.signals[at(m.signal)].size;
      const bool half = m.half != RigidMotion::Half::whole;
      const Node& owner = g.nodes[at(g.signals[at(m.signal)].node)];
      m.node = add_node(g, name_of(g, m), as_block(Integrator{half ? 3 : size}), owner.where);
      Term from{.signal = m.signal};
      if (twice) {
        from.signal = g.nodes[at(find(m, false))].first_signal + 1;
      } else if (half) {
        const int first = m.half == RigidMotion::Half::angular ? 3 : 0;
        from.factors.emplace_back(
            Part{MatrixXd::Identity(6, 6).middleRows(first, 3), first ? ".angular" : ".linear"});
      }
      g.equations.push_back({.target = g.nodes[at(m.node)].first_signal, .terms = {from}});
      motions.push_back(m);
    }
}

/// Integrators for positions and rates that no state holds: once per assembly, as far as the
/// coefficients of those asked for may reach them.
void add_rigid_motions(Stage& stage, Graph& g) {
  std::set<RigidMotion> missing;
  {
    Lowering l(g, stage.values, std::make_shared<const std::vector<Drive>>(drives(g)),
               stage.motions);
    const auto look = [&](const std::vector<Term>& terms) {
      for (const Term& t : terms)
        if (t.of == Term::Of::position || t.of == Term::Of::rate) l.terms({t});
    };
    for (const Equation& e : g.equations) look(e.terms);
    for (const Output& o : g.outputs) look(o.terms);
    missing = l.missing;
  }
  if (missing.empty()) return;
  add_integrators(g, missing, stage.motions);
  // In order of names again; the motions follow by theirs.
  std::vector<std::pair<std::string, std::string>> names;
  for (const RigidMotion& m : stage.motions)
    names.emplace_back(titop::name_of(g, m.signal), g.nodes[at(m.node)].name);
  g = by_name(g);
  for (std::size_t i = 0; i < names.size(); ++i) {
    RigidMotion& m = stage.motions[i];
    for (int n = 0; n < static_cast<int>(g.nodes.size()); ++n)
      if (g.nodes[at(n)].name == names[i].second) m.node = n;
    for (const Channel& c : g.channels)
      if (titop::name_of(g, c.accel) == names[i].first) m.signal = c.accel;
  }
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) list += (i ? ", " : "") + names[i].second;
  stage.notes.push_back(
      {Note::Kind::info, "lower", "motions that no other state holds are integrated: " + list});
}

}  // namespace

Stage lower(Stage stage) {
  Graph source = by_name(stage.graph);
  add_rigid_motions(stage, source);
  stage.source = std::make_shared<const Graph>(std::move(source));
  Graph g = without_equations(*stage.source);
  auto all_drives = std::make_shared<const std::vector<Drive>>(drives(*stage.source));
  Lowering l(*stage.source, stage.values, all_drives, stage.motions);
  if (!g.parameters.empty()) stage.drives = std::move(all_drives);
  Lowered out{l};
  for (int c = 0; c < static_cast<int>(g.channels.size()); ++c) out.channel(c);
  out.one_way();
  int algebraic = 0;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    if (g.nodes[at(i)].block->is_algebraic()) {
      out.algebraic(i);
      g.nodes[at(i)].lowered = true;
      ++algebraic;
    }
  for (int o = 0; o < static_cast<int>(g.outputs.size()); ++o)
    g.outputs[at(o)].terms = out.terms({Origin::Of::output, o}, g.outputs[at(o)].where);
  if (!l.mistakes.empty()) throw Error(std::move(l.mistakes));
  g.equations = std::move(out.equations);
  stage.origins = std::move(out.origins);
  stage.graph = std::move(g);
  stage.notes.push_back(
      {Note::Kind::info, "lower",
       fmt::format("{} nodes ({} of them as coefficients), {} equations", stage.graph.nodes.size(),
                   algebraic, stage.graph.equations.size())});
  return stage;
}

std::vector<std::vector<Term>> lower_again(const Stage& stage, const std::vector<int>& origins,
                                           ParameterValues values) {
  Lowering l(*stage.source, values, stage.drives, stage.motions);
  std::vector<std::vector<Term>> result;
  for (const int o : origins) {
    const Origin& origin = stage.origins[at(o)];
    Sum1 sum = l.amount(origin);
    result.push_back(merged(origin.times.size() ? times(origin.times, std::move(sum)) : sum));
  }
  return result;
}

}  // namespace titop::passes
