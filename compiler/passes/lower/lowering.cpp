#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/passes/lower/lowering.hpp>
#include <titop/compiler/passes/lower/open_motions.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::passes {

using Eigen::MatrixXd;
using linalg::at;

namespace {

void append(Amount& sum, Amount more) {
  if (sum.empty()) {
    sum = std::move(more);
    return;
  }
  for (Summand& t : more) sum.push_back(std::move(t));
}

}  // namespace

/// A motion that is no state: the acceleration in place of its integral, until `integrated`.
Amount Lowering::own_motion(int channel) const {
  const Channel& c = g.channels[at(channel)];
  const MatrixXd I = MatrixXd::Identity(c.size, c.size);
  return {{c.accel, I, I.array() != 0}};
}

/// Accelerations in a position or rate become the outputs of their Integrators; missing ones are
/// noted.
Amount Lowering::integrated(Amount sum, Level level) {
  Amount result;
  for (Summand& p : sum) {
    if (at(p.signal) >= g.signals.size()) {  // shared
      result.push_back(std::move(p));
      continue;
    }
    const Signal& s = g.signals[at(p.signal)];
    if (s.role == Signal::Role::state || s.role == Signal::Role::external) {
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

/// Sum of these equations on their channel, in the channel's own space.
Amount Lowering::added(std::span<const int> equations) {
  Amount sum;
  for (const int e : equations) {
    const Part& part = g.equations[at(e)].part;
    Amount more = terms(g.equations[at(e)].terms);
    append(sum, part.whole() ? std::move(more) : times(part.rows().transpose(), std::move(more)));
  }
  return sum;
}

/// Sum of the terms that `+=` adds to a channel's force. Throws ill_posed if it contains the
/// channel's own reaction.
Amount Lowering::added_to(int channel) {
  if (drive[at(channel)].added.empty()) return {};
  if (std::find(within.begin(), within.end(), channel) != within.end())
    throw Error(Code::ill_posed,
                fmt::format("the reaction at {} depends on itself", channel_name(g, channel)),
                "each of these points is driven by another one: drive one of them by another body, "
                "or ground it");
  within.push_back(channel);
  Amount sum = added(drive[at(channel)].added);
  within.pop_back();
  return sum;
}

Amount Lowering::terms(const std::vector<Term>& list) {
  Amount sum;
  for (const Term& t : list) {
    const bool moves = t.of == Term::Of::position || t.of == Term::Of::rate;
    const Level level = t.of == Term::Of::rate ? Level::rate : Level::position;
    if (moves && readings) {
      readings->emplace_back(g.signals[at(t.signal)].channel, level);
      continue;
    }
    MatrixXd c = coefficient_of(t);
    if (!c.allFinite())
      throw Error(Code::not_finite, fmt::format("the coefficient of {} is not finite", print(g, t)),
                  "look at its gains and parameters");
    const int channel = g.signals[at(t.signal)].channel;
    if (moves) {
      append(sum, integrated(times(c, structure(g, t), motion(channel, level)), level));
      continue;
    }
    if (t.of == Term::Of::reaction) append(sum, times(-c, added_to(channel)));
    sum.push_back({t.signal, std::move(c), numbers_only ? Pattern() : structure(g, t)});
  }
  return sum;
}

/// The position or rate of a channel in terms of states and of motions that are no states: along
/// the equations that drive accelerations, and through bodies by their kinematics.
Amount Lowering::motion(int channel, Level level) {
  const int n = g.channels[at(channel)].size;
  const MatrixXd I = MatrixXd::Identity(n, n);
  Amount sum;
  walk(sum, {channel, I, I.array() != 0}, level);
  return sum;
}

/// Adds factor * motion. A chain is walked along, however long it is; only if an equation has
/// several terms the way forks.
void Lowering::walk(Amount& sum, WayPoint at_channel, Level level) {
  std::vector<int> way;
  std::optional<WayPoint> next = std::move(at_channel);
  while (next) {
    const WayPoint here = std::move(*next);
    next.reset();
    if (visiting[at(here.channel)]) {  // round a closed chain: the motion of all of it
      append(sum, times(here.factor, here.declared, own_motion(here.channel)));
      break;
    }
    if (const int m = shared_motion(here.channel, level); m >= 0) {
      sum.push_back({static_cast<int>(g.signals.size()) + m, here.factor, here.declared});
      if (!shared[at(m)].grounded) next = at_anchor(m, here);
      continue;
    }
    visiting[at(here.channel)] = 1;
    way.push_back(here.channel);
    std::vector<WayPoint> points = step(sum, here, level);
    if (points.size() == 1) next = std::move(points.front());
    for (WayPoint& point : points)
      if (points.size() > 1) walk(sum, std::move(point), level);
  }
  for (const int channel : way) visiting[at(channel)] = 0;
}

/// The points that this one follows, and the motion that it has by itself; none if that is all.
std::vector<Lowering::WayPoint> Lowering::step(Amount& sum, const WayPoint& here, Level level) {
  const Drive& d = drive[at(here.channel)];
  std::vector<WayPoint> ties;
  if (d.accel.empty()) {
    if (auto next = through_body(sum, here, level)) ties.push_back(std::move(*next));
    return ties;
  }
  Amount inputs;
  if (d.free > 0 || !find_ties(here, level, ties, inputs)) {  // prescribed, or in part
    append(sum, times(here.factor, here.declared, own_motion(here.channel)));
    return {};
  }
  append(sum, std::move(inputs));
  return ties;
}

/// The rate or position of w of an opened parameter in an acceleration: an input of its own.
void Lowering::add_opened(const WayPoint& w, Level level, Amount& inputs) {
  const int twin = opened_motion(g, w.channel, level == Level::position);
  if (twin >= 0)
    inputs.push_back({twin, w.factor, w.declared});
  else
    unopened.insert({w.channel, level});
}

/// The points that this one's driven acceleration follows, and the inputs of opened parameters in
/// it; false if something else drives it.
bool Lowering::find_ties(const WayPoint& here, Level level, std::vector<WayPoint>& ties,
                         Amount& inputs) {
  std::vector<WayPoint> opened;  // their w in place of a channel
  const int n = g.channels[at(here.channel)].size;
  for (const int e : drive[at(here.channel)].accel) {
    const Equation& equation = g.equations[at(e)];
    const MatrixXd embed = equation.part.whole() ? MatrixXd::Identity(n, n)
                                                 : MatrixXd(equation.part.rows().transpose());
    for (const Term& t : equation.terms) {
      const Signal& s = g.signals[at(t.signal)];
      const bool w = s.role == Signal::Role::external && g.inputs[at(s.spec)].parameter >= 0;
      if (!w && (s.channel < 0 || s.quantity != Quantity::acceleration || t.of != Term::Of::signal))
        return false;
      WayPoint next{w ? t.signal : s.channel, here.factor * embed * coefficient_of(t),
                    product(here.declared, product(embed, structure(g, t)))};
      (w ? opened : ties).push_back(std::move(next));
    }
  }
  for (const WayPoint& w : opened) add_opened(w, level, inputs);
  return true;
}

/// The opened parameters in the motion of this channel of a body against its reference.
void Lowering::add_opened_motions(Amount& sum, const Node& node, const Kinematics& k,
                                  const WayPoint& by, int spec, double sign, Level level) {
  for (const auto& [port, moving] : opened_ports_of(k)) {
    MatrixXd all = MatrixXd::Zero(by.factor.cols(), static_cast<Eigen::Index>(moving.size()));
    bool moves = false;
    for (std::size_t j = 0; j < moving.size(); ++j)
      if (moving[j]->channel == spec)
        all.col(static_cast<Eigen::Index>(j)) = sign * moving[j]->by, moves = true;
    if (!moves) continue;
    const int w = opened_input(g, node, port);
    add_opened({w, by.factor * all, product(by.declared, Pattern(all.array() != 0))}, level, sum);
  }
}

/// From a point of a body to its parent point, or from that to another that is driven.
std::optional<Lowering::WayPoint> Lowering::through_body(Amount& sum, const WayPoint& here,
                                                         Level level) {
  const Channel& c = g.channels[at(here.channel)];
  const Node& node = g.nodes[at(c.node)];
  const auto k = node.block->kinematics(values);
  const auto add_deformation = [&](int spec, const WayPoint& by, double sign) {
    if (node.state < 0) return;
    MatrixXd Phi = sign * k->Phi[at(spec)];
    if (level == Level::rate) Phi = Phi * node.block->dynamics(values)->A;
    sum.push_back({node.state, by.factor * Phi, product(by.declared, Pattern(Phi.array() != 0))});
  };
  if (k) meet_all(*node.block);
  const auto add_motion = [&](int spec, const WayPoint& by, double sign) {
    add_deformation(spec, by, sign);
    add_opened_motions(sum, node, *k, by, spec, sign, level);
  };
  if (k && c.spec != k->reference) {
    const MatrixXd& tau = k->tau[at(c.spec)];
    add_motion(c.spec, here, 1);
    return WayPoint{node.first_channel + k->reference, here.factor * tau,
                    product(here.declared, Pattern(tau.array() != 0))};
  }
  for (int spec = 0; k && spec < static_cast<int>(k->tau.size()); ++spec) {
    const int other = node.first_channel + spec;
    const MatrixXd& tau = k->tau[at(spec)];
    if (spec == k->reference || drive[at(other)].accel.empty() || tau.rows() != tau.cols())
      continue;
    const linalg::Inverse inverse = linalg::inverse(tau);
    if (inverse.rcond == 0) continue;
    WayPoint step{other, here.factor * inverse.matrix,
                  product(here.declared, Pattern(inverse.matrix.array() != 0))};
    add_motion(spec, step, -1);
    return step;
  }
  append(sum, times(here.factor, here.declared, own_motion(here.channel)));
  return std::nullopt;
}

MatrixXd Lowering::coefficient_of(const Term& t) {
  for (const Factor& f : t.factors)
    if (const auto* k = std::get_if<Value>(&f))
      meet(*k);
    else if (const auto* T = std::get_if<Rotation>(&f))
      meet_all(*T);
  return coefficient(g, t, values);
}

// --- equations --------------------------------------------------------------------------------

Amount Lowering::force(int channel) {
  const Drive& d = drive[at(channel)];
  Amount sum = added(d.force);
  append(sum, added(d.added));
  if (d.all_free()) return sum;  // (a conditional operator would copy it)
  return times(d.some, std::move(sum));
}

/// out = D in.
Amount Lowering::algebraic(int output) {
  if (at(output) >= g.signals.size()) return against_anchor(shared[at(output) - g.signals.size()]);
  const Signal& y = g.signals[at(output)];
  const Node& node = g.nodes[at(y.node)];
  meet_all(*node.block);
  if (asked != y.node) at_hand = node.block->dynamics(values);
  asked = y.node;
  const auto d = at_hand;
  Amount sum;
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

Amount Lowering::all_rows(const Origin& o) {
  flat = o.of == Origin::Of::output;  // no row of the joint system
  switch (o.of) {
    case Origin::Of::accel:
    case Origin::Of::one_way: return terms(g.equations[at(o.index)].terms);
    case Origin::Of::released: return added_to(o.index);
    case Origin::Of::force: return force(o.index);
    case Origin::Of::algebraic: return algebraic(o.index);
    case Origin::Of::output: return terms(g.outputs[at(o.index)].terms);
  }
  return {};
}

Amount Lowering::amount(const Origin& origin) {
  Amount sum = all_rows(origin);
  if (origin.times.size() == 0) return sum;
  return times(origin.times, std::move(sum));
}

std::vector<Term> Lowering::written_out(Origin& origin) {
  met.clear();
  std::vector<Term> result = merged(amount(origin));
  detail::keep_each_once(met);
  origin.parameters = met;
  return result;
}

}  // namespace titop::passes
