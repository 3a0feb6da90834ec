#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/drives.hpp>
#include <unordered_map>

namespace titop::passes {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// What a term is, after its factors.
struct Kind {
  int size = 0;
  Quantity quantity = Quantity::plain;
  int frame = kNoFrame;
};

struct Checker {
  const Graph& graph;
  std::vector<Mistake> mistakes;
  std::vector<Note> notes;
  std::unordered_map<std::string_view, int> node_index = {};

  explicit Checker(const Graph& g) : graph(g), mistakes(g.mistakes) {}

  /// -1 where no node has this name. The index is made where a rotation names its frames.
  int find_node(const std::string& name) {
    if (name.empty()) return -1;
    if (node_index.empty())
      for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        node_index.emplace(graph.nodes[i].name, static_cast<int>(i));
    const auto found = node_index.find(name);
    return found == node_index.end() ? -1 : found->second;
  }

  void add(Code code, std::string message, std::vector<std::string> details, std::string hint) {
    mistakes.push_back({code, std::move(message), std::move(details), std::move(hint)});
  }
};

std::string line(const std::string& text, const std::source_location& where) {
  return fmt::format("{:<50} {}", text, to_string(where));
}

/// One factor of a term; false where the term makes no sense from here on.
bool apply(Checker& c, Kind& kind, const Factor& factor, const Term& term,
           const std::source_location& where) {
  const auto place = [&] { return line(print(c.graph, term), where); };
  if (const auto* k = std::get_if<Value>(&factor)) {
    kind.quantity = Quantity::plain;
    if (!std::isfinite(k->nominal()))
      c.add(Code::not_finite, fmt::format("a gain is {}", k->nominal()), {place()},
            "give a finite gain");
  } else if (const auto* m = std::get_if<Matrix>(&factor)) {
    if (m->value->cols() != kind.size) {
      c.add(Code::size,
            fmt::format("a {}x{} matrix multiplies a signal of size {}", m->value->rows(),
                        m->value->cols(), kind.size),
            {place()}, fmt::format("the matrix needs {} columns", kind.size));
      return false;
    }
    if (!m->value->allFinite())
      c.add(Code::not_finite, "a matrix has entries that are not finite", {place()},
            "check the matrix' source");
    kind = {static_cast<int>(m->value->rows()), Quantity::plain,
            kind.frame == kNoFrame ? kNoFrame : kUnknownFrame};
  } else if (const auto* p = std::get_if<Part>(&factor)) {
    if (p->whole()) return true;
    if (p->rows.cols() != kind.size) {
      c.add(Code::size, fmt::format("{} is taken of a signal of size {}", p->name, kind.size),
            {place()}, ".linear and .angular belong to dual vectors of 6");
      return false;
    }
    kind.size = static_cast<int>(p->rows.rows());
  } else if (const auto& T = std::get<Rotation>(factor); !T.is_identity() || !T.to().empty()) {
    if (kind.size != 3 && kind.size != 6 && !(T.is_identity() && kind.size == 1)) {
      c.add(Code::size, fmt::format("a rotation multiplies a signal of size {}", kind.size),
            {place()}, "rotations act on vectors of 3 and dual vectors of 6");
      return false;
    }
    const int from = c.find_node(T.from()), to = c.find_node(T.to());
    if (kind.frame >= 0 && from >= 0 && from != kind.frame) {
      c.add(Code::frame,
            fmt::format("the rotation {}<-{} meets a signal in {}", T.to(), T.from(),
                        frame_name(c.graph, kind.frame)),
            {place()}, "use its inverse(), or name the frames that it really has");
    }
    kind.frame = to >= 0 ? to : kUnknownFrame;
  }
  return true;
}

/// Kind of a term; size -1 where it makes no sense (already noted).
Kind describe(Checker& c, const Term& term, const std::source_location& where) {
  if (term.signal < 0) return {-1};
  const Signal& s = c.graph.signals[at(term.signal)];
  Kind kind{s.size, s.quantity, s.frame};
  if (term.of == Term::Of::position) kind.quantity = Quantity::position;
  if (term.of == Term::Of::rate) kind.quantity = Quantity::velocity;
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f)
    if (!apply(c, kind, *f, term, where)) return {-1};
  return kind;
}

std::string frame_hint(const Checker& c, int target, const Term& term) {
  const Signal& t = c.graph.signals[at(target)];
  const Signal& s = c.graph.signals[at(term.signal)];
  const std::string plain = print(c.graph, Term{term.signal, term.of, 1, {}});
  if (t.channel >= 0 && s.channel >= 0 && t.quantity == Quantity::acceleration)
    return fmt::format("write mount({}, {}, T_ba), or T_ba.inverse() * {}",
                       c.graph.nodes[at(t.node)].name, channel_name(c.graph, s.channel), plain);
  return fmt::format("write T * {} with the rotation T that takes it from one frame to the other",
                     plain);
}

/// The right-hand side of an equation or output. What it says of itself costs more than the checks:
/// only mistakes ask for it.
struct RightSide {
  const std::vector<Term>& terms;
  const std::source_location& where;
  int target = -1;  ///< signal; -1: an output
  std::function<std::string()> name, text;
};

/// All terms against what they drive. `expected.frame` kNoFrame adopts the first frame met.
void check_terms(Checker& c, const RightSide& side, Kind expected) {
  const bool adopts_frame = expected.frame == kNoFrame;
  const Term* from = nullptr;  // whose kind or frame is expected; none: the target's
  const auto place = [&] { return line(side.text(), side.where); };
  const auto origin = [&] { return from ? print(c.graph, *from) : side.name(); };
  for (const Term& term : side.terms) {
    const Kind kind = describe(c, term, side.where);
    if (kind.size < 0) continue;
    if (kind.size != expected.size) {
      c.add(Code::size,
            fmt::format("{} has size {}, its equation has {} of size {}", side.name(),
                        expected.size, print(c.graph, term), kind.size),
            {place()},
            fmt::format("both sides must have size {}; take .linear, .angular or "
                        ".along(r), or give the {} another size",
                        expected.size, side.target < 0 ? "output" : "signal"));
      continue;
    }
    if (expected.quantity == Quantity::plain && kind.quantity != Quantity::plain) {
      expected.quantity = kind.quantity;
      from = &term;
    } else if (kind.quantity != Quantity::plain && kind.quantity != expected.quantity) {
      c.add(Code::quantity,
            fmt::format("{} is of kind {}, {} of kind {}", origin(), to_string(expected.quantity),
                        print(c.graph, term), to_string(kind.quantity)),
            {place()}, "a gain with units in front, as k * signal, makes it a plain signal");
    }
    if (kind.frame == kUnknownFrame) {
      c.notes.push_back({Note::Kind::unchecked, "check",
                         fmt::format("{}: the frame of {} is unknown ({})", side.name(),
                                     print(c.graph, term), to_string(side.where))});
    } else if (kind.frame != kNoFrame) {
      if (expected.frame == kNoFrame && adopts_frame) {
        expected.frame = kind.frame;
        from = &term;
      } else if (expected.frame >= 0 && kind.frame != expected.frame) {
        c.add(
            Code::frame,
            fmt::format("{} is in {}, its equation is in {}", adopts_frame ? origin() : side.name(),
                        frame_name(c.graph, expected.frame), frame_name(c.graph, kind.frame)),
            {place()},
            side.target < 0 ? "rotate one of them first" : frame_hint(c, side.target, term));
      }
    }
  }
}

void check_equation(Checker& c, const Equation& e) {
  const Signal& s = c.graph.signals[at(e.target)];
  const Kind expected{e.part.whole() ? s.size : static_cast<int>(e.part.rows.rows()), s.quantity,
                      s.frame};
  check_terms(c,
              {e.terms, e.where, e.target, [&] { return name_of(c.graph, e.target) + e.part.name; },
               [&] { return print(c.graph, e); }},
              expected);
}

std::string added_at(const Graph& graph, int node) {
  const Node& n = graph.nodes[at(node)];
  return fmt::format("{} was added at {}", n.name, to_string(n.where));
}

/// Overlap of two driven parts of one channel.
bool overlap(const Equation& a, const Equation& b) {
  if (a.part.whole() || b.part.whole()) return true;
  return (a.part.rows * b.part.rows.transpose()).cwiseAbs().maxCoeff() > 1e-12;
}

/// Two driven parts that share some of their directions, and not all of them.
bool oblique(const Equation& a, const Equation& b) {
  if (a.part.whole() || b.part.whole()) return false;
  const Eigen::MatrixXd &A = a.part.rows, &B = b.part.rows;
  const Eigen::MatrixXd left = B - B * A.transpose() * A;
  return left.rowwise().norm().minCoeff() > 1e-9;
}

/// The direction of b that is at right angles to a, where both are one: "(0, 0.6, 0.8)".
std::string oblique_way_out(const Equation& a, const Equation& b) {
  const Eigen::MatrixXd &A = a.part.rows, &B = b.part.rows;
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

void check_channel(Checker& c, const Channel& channel, const Drive& drive) {
  const Graph& g = c.graph;
  const int index = static_cast<int>(&channel - g.channels.data());
  std::vector<int> set(drive.accel.begin(), drive.accel.end());
  set.insert(set.end(), drive.force.begin(), drive.force.end());
  int rows = 0;
  bool clash = false;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Equation& a = g.equations[at(set[i])];
    rows += a.part.whole() ? channel.size : static_cast<int>(a.part.rows.rows());
    for (std::size_t j = 0; j < i; ++j) {
      const Equation& b = g.equations[at(set[j])];
      if (!overlap(a, b)) continue;
      clash = true;
      const bool same = a.target == b.target;
      if (oblique(b, a)) {
        c.add(Code::two_equations,
              fmt::format("{}{} and {}{} are both driven, and are not at right angles",
                          name_of(g, b.target), b.part.name, name_of(g, a.target), a.part.name),
              {line(print(g, b), b.where), line(print(g, a), a.where)}, oblique_way_out(b, a));
        continue;
      }
      c.add(Code::two_equations,
            same ? fmt::format("{} is driven twice", name_of(g, a.target))
                 : fmt::format("{} is driven on both sides, acceleration and force",
                               channel_name(g, index)),
            {line(print(g, b), b.where), line(print(g, a), a.where)},
            same ? "keep one of them; to add a force write += instead of ="
                 : "keep one of them; the other side can be read");
    }
  }
  const bool child = channel.takes == Takes::force;
  if (!clash && rows < channel.size && !child && drive.added.empty()) {
    const std::string what =
        rows == 0 ? name_of(g, channel.accel)
                  : fmt::format("{} ({} of {} degrees of freedom)", name_of(g, channel.accel),
                                channel.size - rows, channel.size);
    c.add(Code::no_equation, fmt::format("{} is not driven", what), {added_at(g, channel.node)},
          free_way_out(g, channel));
  }
}

/// What the forces of other points take from a channel's force.
struct Passed {
  bool whole = false;     ///< all of it
  bool reaction = false;  ///< less what was added to it
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

/// Where a point moves with another, its force is what that takes; what `+=` adds acts through the
/// reaction alone. To pass on the whole force is to say that nothing was added.
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
        fmt::format("what is added to {} goes nowhere: its acceleration is driven, and the whole "
                    "force is passed on",
                    name_of(g, channel.force)),
        {line(print(g, a), a.where), line(print(g, b), b.where)},
        "pass on the port's reaction, the force less what is added, as mount does; or add to the "
        "force of the point that it moves with");
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
            {line(print(g, b), b.where), line(print(g, e), e.where)},
            "keep one of them, or write their sum");
    }
    first = static_cast<int>(i);
  }
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    const Signal& sig = g.signals[at(s)];
    if (sig.role == Signal::Role::input && sig.channel < 0 && driver[at(s)] < 0)
      c.add(Code::no_equation, fmt::format("{} is not driven", name_of(g, s)),
            {added_at(g, sig.node)},
            fmt::format("write {} = ..., or {} = 0", name_of(g, s), name_of(g, s)));
  }
}

void check_outputs(Checker& c) {
  for (const Output& o : c.graph.outputs) {
    if (!o.set) {
      c.add(Code::no_equation, fmt::format("output {} is not set", o.name),
            {"it was declared at " + to_string(o.where)},
            fmt::format("write d.output(\"{}\") = ...", o.name));
      continue;
    }
    const auto text = [&] {
      std::string all = fmt::format("output(\"{}\") = ", o.name);
      for (std::size_t i = 0; i < o.terms.size(); ++i)
        if (o.terms[i].signal >= 0) all += (i ? " + " : "") + print(c.graph, o.terms[i]);
      return all;
    };
    check_terms(c, {o.terms, o.where, -1, [&] { return "output " + o.name; }, text},
                {o.size, Quantity::plain, kNoFrame});
  }
}

template <class List>
void check_names(Checker& c, const List& list, std::string_view what) {
  std::unordered_map<std::string_view, const std::source_location*> seen;
  seen.reserve(list.size());
  for (const auto& item : list) {
    if (item.name.empty()) {
      c.add(Code::duplicate_name, fmt::format("a {} has no name", what),
            {"written at " + to_string(item.where)}, "give it a name of its own");
      continue;
    }
    const auto [first, is_new] = seen.emplace(item.name, &item.where);
    if (!is_new)
      c.add(Code::duplicate_name, fmt::format("two {}s are called {}", what, item.name),
            {"the first is at " + to_string(*first->second),
             "the second is at " + to_string(item.where)},
            "names come out with the model: give each its own");
  }
}

}  // namespace

Stage check(Stage stage) {
  Checker c(stage.graph);
  check_names(c, stage.graph.nodes, "node");
  check_names(c, stage.graph.inputs, "input");
  check_names(c, stage.graph.outputs, "output");
  check_names(c, stage.graph.parameters, "parameter");
  for (const Equation& e : stage.graph.equations) check_equation(c, e);
  const Drives all(stage.graph);
  for (std::size_t i = 0; i < all.size(); ++i) check_channel(c, stage.graph.channels[i], all[i]);
  std::vector<Passed> passed;  // only looked for where something is added to what is driven
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].added.empty() || all[i].accel.empty()) continue;
    if (passed.empty()) passed = passed_on(stage.graph);
    if (passed[i].whole && !passed[i].reaction) check_added(c, stage.graph.channels[i], all[i]);
  }
  check_one_way(c);
  check_outputs(c);
  if (!c.mistakes.empty()) throw Error(std::move(c.mistakes));
  stage.notes.insert(stage.notes.end(), c.notes.begin(), c.notes.end());
  return stage;
}

}  // namespace titop::passes
