#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/certify/faults.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::report {
namespace {

using certification::kHolds;

enum class Mark { good, bad, none };

struct Item {
  std::string item, value, meaning;
  Mark mark = Mark::none;
};

std::string place(std::complex<double> s) {
  return fmt::format("s = {:.3g} {} {:.3g} j rad/s", s.real(), s.imag() < 0 ? "−" : "+",
                     std::abs(s.imag()));
}

Mark judged(double value, double limit) { return value <= limit ? Mark::good : Mark::bad; }

void add_not_done(std::vector<Item>& items, const char* item, const std::string& why_not) {
  items.push_back({item, "not checked", why_not});
}

void add_basic(std::vector<Item>& items, const Certificate& c) {
  if (c.residual < 0)
    add_not_done(items, "every equation, as it was written", "Without inputs nothing moves.");
  else
    items.push_back(
        {"every equation, as it was written", number(c.residual, 2),
         fmt::format(
             "With a random input {} s = {:.3g} rad/s, all signals as the compiled system gives "
             "them: the largest difference of the two sides of an equation or of a block's rows, "
             "over the sum of the magnitudes of their terms. Rounding alone leaves about 10⁻¹⁶ per "
             "term.{}",
             c.at_instant ? "and states as single blocks would have at" : "at", c.s,
             c.residual_where.empty() ? "" : " Worst: " + c.residual_where + "."),
         judged(c.residual, kHolds)});
  if (c.apply_against_transfer >= 0)
    items.push_back(
        {"rates at an instant against the transfer", number(c.apply_against_transfer, 2),
         fmt::format("The largest relative difference of s x and ẋ, and of the outputs, for one "
                     "random input at s = {:.3g} rad/s: by two eliminations.",
                     c.s),
         judged(c.apply_against_transfer, kHolds)});
  if (c.dense_against_factors >= 0)
    items.push_back(
        {"A, B, C, D against the factored system", number(c.dense_against_factors, 2),
         "The largest relative difference of the rates and outputs for one random state "
         "and input.",
         judged(c.dense_against_factors, kHolds)});
  if (c.dense_error >= 0)
    items.push_back(
        {"effect of rounding A, B, C, D", number(c.dense_error, 2),
         fmt::format(
             "The largest change of an output due to writing the model in 16 digits, over that "
             "output's largest size; found at {}. Over its size at the same s: {}, found at {}.",
             place(c.dense_error_s), number(c.dense_error_where_small, 2),
             place(c.dense_error_where_small_s)),
         judged(c.dense_error, certification::kDenseHolds)});
  items.push_back({"weakest pivot", number(c.weakest_pivot, 2),
                   fmt::format("The pivot over the sum of the magnitudes of its terms{}: 1 is no "
                               "cancellation, 10⁻¹⁶ no digit. The same in all units.",
                               c.weakest_where.empty() ? "" : ", at " + c.weakest_where)});
  items.push_back(
      {"growth of the entries", number(c.pivot_growth, 3),
       "The largest size of a row over the least that it had before, all along the tree."});
  items.push_back(
      {"margin of the algebraic loops", number(c.margin, 3),
       fmt::format("1 without a loop, about 4/δ at a relative distance δ from a loop without a "
                   "solution{}.{}",
                   c.margin_where.empty() ? "" : "; here at " + c.margin_where,
                   c.margin_is_exact ? "" : " Larger loops are checked by a known solution.")});
}

void add_reciprocity(std::vector<Item>& items, const FullCertificate::Reciprocity& r) {
  if (!r.done) return add_not_done(items, "reciprocity", r.why_not);
  items.push_back({"reciprocity", number(r.asymmetry, 2),
                   fmt::format("Of {}: the largest |G_ij - G_ji| over sqrt(|G_ii| |G_jj|), G_ij "
                               "the acceleration at force i due to force j{}{}{}.",
                               count(static_cast<std::size_t>(r.forces), "force"),
                               r.reversed ? fmt::format(", G_ji with all momenta reversed ({})",
                                                        passes::momenta_text(r.momenta))
                                          : "",
                               r.first.empty() ? "" : fmt::format("; {} and {}", r.first, r.second),
                               r.structure ? "" : "; not required: " + r.why_no_structure),
                   r.structure ? judged(r.asymmetry, kHolds) : Mark::none});
}

void add_full(std::vector<Item>& items, const FullCertificate& f) {
  if (f.grid.done) {
    const std::string over = fmt::format(
        "Largest difference of transfers at {} points between {:.3g} and {:.3g} rad/s, by output "
        "and input over the largest there (three translations or rotations of a port together)",
        f.grid.points, f.grid.lowest, f.grid.highest);
    if (f.grid.dense >= 0)
      items.push_back({"minimal A, B, C, D against the factored system over a grid",
                       number(f.grid.dense, 2),
                       over + "; values that may be rounding alone, as by symmetry, over 10⁻³ of "
                              "the terms that cancel in them.",
                       judged(f.grid.dense, certification::kDenseHolds)});
    if (f.grid.written >= 0)
      items.push_back({"the equations as written, solved all at once, against the factored system",
                       number(f.grid.written, 2),
                       over + ", or over 10⁻³ of the terms that cancel in it.",
                       judged(f.grid.written, kHolds)});
  } else {
    add_not_done(items, "transfers over a grid", f.grid.why_not);
  }
  if (f.poles.done && f.poles.measured > 0)
    items.push_back(
        {"error of the poles", number(f.poles.error, 2),
         fmt::format("To first order, by the factors' products with the vectors of each pole{}.",
                     f.poles.measured == f.poles.count
                         ? ""
                         : fmt::format("; {} of {}, the others rounding of A alone moves too far",
                                       f.poles.measured, f.poles.count)),
         judged(f.poles.error, certification::kPoleHolds)});
  if (f.poles.done)
    items.push_back(
        {"poles right of the imaginary axis", fmt::format("{}", f.poles.right),
         f.poles.right == 0
             ? fmt::format("None{} grows: at 0, on the axis, or left of it.",
                           f.poles.measured < f.poles.count ? " that was measured" : "")
             : fmt::format("The model is unstable; rightmost at {}.", place(f.poles.rightmost))});
  else
    add_not_done(items, "poles", f.poles.why_not);
  if (f.passivity.done)
    items.push_back(
        {"passivity", number(f.passivity.least, 3),
         fmt::format("Smallest eigenvalue of the Hermitian part of G(s)/s over {} of force and "
                     "acceleration at one point, scaled: not negative for a passive structure{}. "
                     "Found at {}.",
                     count(static_cast<std::size_t>(f.passivity.pairs), "pair"),
                     f.passivity.structure ? "" : "; a controller may supply energy",
                     place(f.passivity.where)),
         f.passivity.structure ? judged(-f.passivity.least, certification::kPassive) : Mark::none});
  else
    add_not_done(items, "passivity", f.passivity.why_not);
  add_reciprocity(items, f.reciprocity);
}

std::string marked(Mark mark) {
  return mark == Mark::good  ? "<span class=\"good\">✓ holds</span>"
         : mark == Mark::bad ? "<span class=\"bad\">✗ does not hold</span>"
                             : "";
}

/// The verdict with exact arithmetic, if it was computed.
const OrderVerdict& order_of(const Subject& s, const FullCertificate* full) {
  return full && full->order.judged ? full->order : s.system.order_verdict();
}

std::string as_range(const OrderVerdict& v) {
  if (!v.judged)
    return fmt::format("Order {}: by structure only; it may contain modes without effect.",
                       v.order);
  if (!v.decided())
    return fmt::format(
        "Order {} is undecided: at this precision the minimal order lies between {} "
        "and {}{}{}.",
        v.order, v.lowest, v.highest,
        v.highest > v.order
            ? "; the removed modes have no effect that this precision distinguishes from 0"
            : "",
        v.lowest < v.order ? "; undecided modes are kept" : "");
  return fmt::format("Order {} is minimal{}.", v.order,
                     v.exact ? ", decided in exact arithmetic" : ", decided beyond rounding");
}

std::string verdict(const char* cls, const std::string& html) {
  return fmt::format("<li class=\"{}\">{}</li>\n", cls, html);
}

std::string tile(const std::string& value, const std::string& item) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", value, item);
}

std::string tiles(const Subject& s) {
  const OrderVerdict& v = s.system.order_verdict();
  std::string frequencies = "–";
  for (const Pole& p : s.poles)
    if (p.pair && p.omega > 0) {
      frequencies = number(p.hertz, 4) + " Hz";
      break;
    }
  double least = HUGE_VAL;
  for (const Pole& p : s.poles)
    if (p.pair) least = std::min(least, p.damping);
  return "<div class=\"tiles\">\n" +
         tile(fmt::format("{}", v.order), v.order == 1 ? "state" : "states") +
         tile(fmt::format("{}", s.inputs.size()), s.inputs.size() == 1 ? "input" : "inputs") +
         tile(fmt::format("{}", s.outputs.size()), s.outputs.size() == 1 ? "output" : "outputs") +
         tile(frequencies, "lowest mode") +
         tile(std::isfinite(least) ? number(100 * least, 3) + " %" : "–", "least damping") +
         "</div>\n";
}

/// Slower than this, of the fastest pole, a pole may be one at 0: a double one moves by the root of
/// rounding, 1.5e-8, and by more if it is ill-conditioned.
constexpr double kNearZero = 1e-7;
/// One by itself moves by rounding of A alone.
constexpr double kAtZero = 1e-14;

/// Numbers of poles of the shown model by region.
struct PoleCounts {
  int zero = 0;
  int near = 0;  ///< right of the axis, but not far from 0
  int axis = 0, right = 0;
};

PoleCounts pole_counts(const std::vector<Pole>& poles) {
  PoleCounts found;
  const double fastest = poles.empty() ? 0 : poles.back().omega;
  for (const Pole& p : poles) {
    const int n = p.pair ? 2 : 1;
    if (p.omega <= kAtZero * fastest)
      found.zero += n;
    else if (p.omega <= kNearZero * fastest && p.s.real() > 0)
      found.near += n;
    else if (p.s.real() > linalg::kPoleOnAxis * p.omega)
      found.right += n;
    else if (p.s.real() >= -linalg::kPoleOnAxis * p.omega)
      found.axis += n;
  }
  return found;
}

std::size_t set_aside(const Graph& g) {
  std::size_t states = 0;
  for (const Signal& x : g.signals)
    if (x.role == Signal::Role::state && !x.active) states += static_cast<std::size_t>(x.size);
  return states;
}

std::string poles(int n) { return count(static_cast<std::size_t>(n), "pole"); }

/// Hidden poles are missing in the minimal model, which may be stable although the scene is not.
std::string unstable(const PoleCounts& shown, int right) {
  const int hidden = right - shown.right - shown.near;
  std::string text = fmt::format("<b>Unstable</b>: {} right of the imaginary axis", poles(right));
  if (hidden > 0)
    text += fmt::format(
        "; {} no input moves or no output sees, so that the minimal model and all responses of "
        "this page leave {} out",
        hidden == right ? (hidden == 1 ? "this one" : "these") : fmt::format("{} of them", hidden),
        hidden == 1 ? "it" : "them");
  return verdict("bad", text + ".");
}

/// By the poles of all states, if the certificate has them, else by those of the minimal model.
std::string stability(const Subject& s, const FullCertificate* full) {
  const PoleCounts p = pole_counts(s.poles);
  const FullCertificate::Poles* all = full && full->poles.done ? &full->poles : nullptr;
  const int right = all ? all->right : p.right;
  if (right > 0) return unstable(p, right);
  // A pole by itself has all its digits; those at 0 that are several have not.
  const bool several = all && all->count - all->measured >= 2;
  if (p.right > 0 || (p.near > 0 && !several))
    return verdict(
        "open",
        fmt::format("<b>Undecided</b>: {} right of the imaginary axis, {}: rounding, or "
                    "unstable.{}",
                    poles(p.right + p.near),
                    all ? "by no more than rounding may move poles" : "within 1e-7 of the fastest",
                    all ? "" : " The full certificate may tell (titop certify)."));
  const bool unseen = !all && !s.system.order_verdict().removed.empty();
  const int zero = p.zero + p.near;
  std::string text =
      unseen ? "<b>No pole</b> of the minimal model lies right of the imaginary axis; those of the "
               "removed modes were not checked"
      : zero + p.axis > 0 ? "<b>No pole</b> lies right of the imaginary axis"
                          : "<b>Stable</b>: all poles lie left of the imaginary axis";
  if (zero > 0) text += fmt::format("; {} at 0 (free motion, integrators)", zero);
  if (p.near > 0)
    text += fmt::format("; {} of them by rounding only, within 1e-7 of the fastest pole", p.near);
  if (p.axis > 0) text += fmt::format("; {} on the axis (undamped)", p.axis);
  if (const std::size_t aside = set_aside(s.system.stage().graph); aside > 0)
    text += fmt::format(
        "; not looked at: {} that the structure left out (see <a href=\"#order\">Order</a>)",
        count(aside, "state"));
  return verdict(unseen ? "open" : "good", text + ".");
}

std::string what_holds(const Certificate& c, const FullCertificate* full) {
  std::vector<std::string> list;
  if (c.residual >= 0)
    list.push_back("every equation of the diagram, as it was written, to " + number(c.residual, 2));
  if (full && full->poles.done) list.push_back("poles");
  if (full && full->grid.done) list.push_back("dense model and transfers over a grid");
  return list.empty() ? "" : fmt::format(": {}", fmt::join(list, "; "));
}

}  // namespace

std::string certificate_section(const Subject& s, const FullCertificate* full) {
  std::vector<Item> items;
  add_basic(items, s.system.dense_certificate());
  if (full) add_full(items, *full);
  const std::vector<std::string> classes = {"", "n", "fit", "wide"};
  std::string text =
      "<p>The checks of this model, each by another method than the one that computed it. All "
      "numbers are dimensionless; checks that are not listed were not made.</p>\n"
      "<div class=\"table\"><table class=\"certificate\">\n<thead>" +
      row({"check", "number", "", "meaning"}, {"", "n", "", ""}, "th") + "</thead>\n<tbody>\n";
  for (const Item& i : items)
    text += row({escaped(i.item), i.value, marked(i.mark), escaped(i.meaning)}, classes);
  text += "</tbody></table></div>\n";
  if (!full)
    text += fmt::format(
        "<p class=\"note\">Poles, passivity, reciprocity and transfers over a grid were not "
        "checked: {} states are more than {} (ReportOptions::full_up_to).</p>\n",
        s.system.order(), s.options.full_up_to);
  return text;
}

std::string order_section(const Subject& s, const FullCertificate* full) {
  const OrderVerdict& v = order_of(s, full);
  std::string text = "<p>" + as_range(v) + "</p>\n";
  if (v.judged && v.order > 0)
    text += fmt::format(
        "<p>A mode's visibility is the relative half-bandwidth in which it stands out of the rest "
        "of "
        "the transfer: a pure number, the same in all units. The least visible mode that stays has "
        "{}{}{}.</p>\n",
        number(v.to_fewer, 2),
        v.removed.empty()
            ? ""
            : fmt::format("; the most visible one that left, {}", number(v.to_more, 2)),
        v.change < 0 ? ""
                     : fmt::format("; near the removed modes the transfer changed by {}, measured",
                                   number(v.change, 2)));
  const auto table = [&](const std::vector<JudgedMode>& modes, const char* title) {
    if (modes.empty()) return;
    text +=
        fmt::format("<h3>{}</h3>\n<div class=\"table\"><table class=\"modes\">\n<thead>", title) +
        row({"mode [rad/s]", "states", "visibility", "rounding alone may make", "why"},
            {"n", "n", "n", "n", ""}, "th") +
        "</thead>\n<tbody>\n";
    for (const JudgedMode& m : modes)
      text += row({number(m.omega, 6), fmt::format("{}", m.states), number(m.visibility, 2),
                   number(m.bound, 2), escaped(m.why)},
                  {"n", "n", "n", "n", ""});
    text += "</tbody></table></div>\n";
  };
  table(v.removed, "Taken out: modes without effect on the transfer");
  table(v.undecided, "In doubt, and kept");
  std::string list;
  for (const Note& n : s.system.notes())
    if (n.kind == Note::Kind::removed) list += fmt::format("<li>{}</li>\n", escaped(n.text));
  text += list.empty() ? "<p>The structure alone left nothing out.</p>\n"
                       : "<h3>Left out by the structure, exactly</h3>\n<ul>\n" + list + "</ul>\n";
  return text;
}

std::string summary(const Subject& s, const FullCertificate* full) {
  const Certificate c = s.system.dense_certificate();
  const OrderVerdict& v = order_of(s, full);
  std::string text = tiles(s) + "<ul class=\"verdicts\">\n" + stability(s, full);
  const std::vector<std::string> faults = full ? full->faults : certification::basic_faults(c);
  for (const std::string& fault : faults) text += verdict("bad", escaped(fault));
  if (faults.empty()) text += verdict("good", "<b>All checks hold</b>" + what_holds(c, full) + ".");
  text += verdict(v.decided() ? "good" : "open", as_range(v));
  for (const auto& notes : {s.system.notes(), s.system.dense_notes()})
    for (const Note& n : notes)
      if (n.kind == Note::Kind::warning || n.kind == Note::Kind::unchecked)
        text += verdict("open", fmt::format("<b>{}</b> ({}): {}",
                                            n.kind == Note::Kind::warning ? "Warning" : "Unchecked",
                                            escaped(n.pass), escaped(n.text)));
  return text + "</ul>\n";
}

}  // namespace titop::report
