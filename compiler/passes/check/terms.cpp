#include <algorithm>
#include <cmath>
#include <functional>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// Half of a dual vector: translations and forces, or rotations and torques.
enum class TermHalf { any, linear, angular };

/// Type of a term, after its factors.
struct TermType {
  int size = 0;
  Quantity quantity = Quantity::plain;
  int frame = kNoFrame;
  TermHalf half = TermHalf::any;  ///< any: of all else, and if it is not known
};

/// Half to which a part of a signal belongs. A joint's axis may be either.
TermHalf half_of(const Part& part, Quantity quantity) {
  const Eigen::MatrixXd& rows = part.rows();
  if (quantity == Quantity::plain || rows.cols() != 6) return TermHalf::any;
  return rows.rightCols<3>().isZero(0)  ? TermHalf::linear
         : rows.leftCols<3>().isZero(0) ? TermHalf::angular
                                        : TermHalf::any;
}

const char* word(TermHalf half) { return half == TermHalf::linear ? "linear" : "angular"; }

/// Two nodes of one name are a mistake of their own: their frames count as equal.
bool same_frame(const Checker& c, int a, int b) {
  return a == b || c.graph.nodes[at(a)].name == c.graph.nodes[at(b)].name;
}

/// The rotation does not fit the frame that it meets: told once per line, as `mount` uses T_ba in
/// both directions.
void refuse_rotation(Checker& c, const Rotation& T, int frame, const Term& term,
                     const Written& where) {
  const std::string place = line(print(c.graph, term), where);
  const std::string met = frame_name(c.graph, frame);
  if (const int to = c.find_node(T.to()); to < 0 || !same_frame(c, to, frame))
    return c.add(Code::frame,
                 fmt::format("the rotation {}<-{} meets a signal in {}", T.to(), T.from(), met),
                 {place}, "use its inverse(), or name the frames that it really has");
  const auto [first, second] = std::minmax(T.to(), T.from());
  if (!c.reversed.insert(fmt::format("{}\n{}\n{}", where.text(), first, second)).second) return;
  c.add(Code::frame,
        fmt::format("the rotation between {0} and {1} is used in the wrong direction: as {0}<-{1} "
                    "it meets a signal in {2}",
                    T.to(), T.from(), met),
        {place},
        fmt::format("exchange its two names, or use its inverse(): named(\"{0}\", \"{1}\") takes "
                    "components in {1} to components in {0}",
                    T.to(), T.from()));
}

/// One factor of a term; false if the term makes no sense from here on.
bool apply(Checker& c, TermType& kind, const Factor& factor, const Term& term,
           const Written& where) {
  const auto place = [&] { return line(print(c.graph, term), where); };
  if (const auto* k = std::get_if<Value>(&factor)) {
    kind.quantity = Quantity::plain;
    kind.half = TermHalf::any;
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
    if (p->rows().cols() != kind.size) {
      c.add(Code::size, fmt::format("{} is taken of a signal of size {}", p->name(), kind.size),
            {place()}, ".linear and .angular belong to dual vectors of 6");
      return false;
    }
    if (kind.size == 6) kind.half = half_of(*p, kind.quantity);
    kind.size = static_cast<int>(p->rows().rows());
  } else if (const auto& T = std::get<Rotation>(factor); T.is_identity() && T.nameless()) {
    if (kind.frame >= 0) kind.frame = kNoFrame;  // the same axes in any frame
  } else {
    if (kind.size != 3 && kind.size != 6 && !(T.is_identity() && kind.size == 1)) {
      c.add(Code::size, fmt::format("a rotation multiplies a signal of size {}", kind.size),
            {place()}, "rotations act on vectors of 3 and dual vectors of 6");
      return false;
    }
    const int from = c.find_node(T.from()), to = c.find_node(T.to());
    const bool fits = kind.frame < 0 || from < 0 || same_frame(c, from, kind.frame);
    if (!fits) refuse_rotation(c, T, kind.frame, term, where);
    kind.frame = !fits ? kNoFrame : to >= 0 ? to : kUnknownFrame;
  }
  return true;
}

/// Type of a term; size -1 if it makes no sense (already noted).
TermType describe(Checker& c, const Term& term, const Written& where) {
  if (term.signal < 0) return {-1};
  const Signal& s = c.graph.signals[at(term.signal)];
  TermType kind{s.size, s.quantity, s.frame};
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

/// The right-hand side of an equation or output. Its name and text cost more than the checks and
/// are made for mistakes only.
struct RightSide {
  const std::vector<Term>& terms;
  Written where;
  int target = -1;  ///< signal; -1: an output
  std::function<std::string()> name, text;
};

/// Checks all terms against the target. `expected.frame` kNoFrame adopts the first frame met.
void check_terms(Checker& c, const RightSide& side, TermType expected) {
  const bool adopts_frame = expected.frame == kNoFrame;
  const Term* from = nullptr;  // whose kind or frame is expected; none: the target's
  const auto place = [&] { return line(side.text(), side.where); };
  const auto origin = [&] { return from ? print(c.graph, *from) : side.name(); };
  for (const Term& term : side.terms) {
    const TermType kind = describe(c, term, side.where);
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
      expected.half = kind.half;
      from = &term;
    } else if (kind.quantity != Quantity::plain && kind.quantity != expected.quantity) {
      c.add(Code::quantity,
            fmt::format("{} is of kind {}, {} of kind {}", origin(), to_string(expected.quantity),
                        print(c.graph, term), to_string(kind.quantity)),
            {place()}, "a gain with units in front, as k * signal, makes it a plain signal");
    } else if (expected.half == TermHalf::any && kind.half != TermHalf::any) {
      expected.half = kind.half;
      from = &term;
    } else if (kind.half != TermHalf::any && kind.half != expected.half) {
      c.add(Code::quantity,
            fmt::format("{} is {}, {} is {}", origin(), word(expected.half), print(c.graph, term),
                        word(kind.half)),
            {place()},
            "take the same half of both; a gain with units in front, as r * signal, makes it a "
            "plain signal");
    }
    if (kind.frame == kUnknownFrame) {
      c.notes.push_back({Note::Kind::unchecked, "check",
                         fmt::format("{}: the frame of {} is unknown ({})", side.name(),
                                     print(c.graph, term), side.where.text())});
    } else if (kind.frame != kNoFrame) {
      if (expected.frame == kNoFrame && adopts_frame) {
        expected.frame = kind.frame;
        from = &term;
      } else if (expected.frame >= 0 && !same_frame(c, kind.frame, expected.frame)) {
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
  const TermType expected{e.part.whole() ? s.size : static_cast<int>(e.part.rows().rows()),
                          s.quantity, s.frame, half_of(e.part, s.quantity)};
  check_terms(c,
              {e.terms, written(c.graph, e), e.target,
               [&] { return name_of(c.graph, e.target) + e.part.name(); },
               [&] { return print(c.graph, e); }},
              expected);
}

}  // namespace

void check_equations(Checker& c) {
  for (const Equation& e : c.graph.equations) check_equation(c, e);
}

void check_outputs(Checker& c) {
  for (const Output& o : c.graph.outputs) {
    const Written where = written(c.graph.outputs, "outputs", o);
    if (!o.set) {
      c.add(Code::no_equation, fmt::format("output {} is not set", o.name),
            {"it was declared at " + where.text()},
            fmt::format("write d.output(\"{}\") = ...", o.name));
      continue;
    }
    const auto text = [&] {
      std::string all = fmt::format("output(\"{}\") = ", o.name);
      for (std::size_t i = 0; i < o.terms.size(); ++i)
        if (o.terms[i].signal >= 0) all += (i ? " + " : "") + print(c.graph, o.terms[i]);
      return all;
    };
    check_terms(c, {o.terms, where, -1, [&] { return "output " + o.name; }, text},
                {o.size, Quantity::plain, kNoFrame});
  }
}

}  // namespace titop::passes
