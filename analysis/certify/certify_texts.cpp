#include <fmt/format.h>

#include <algorithm>
#include <titop/analysis/certify/certify_full.hpp>
#include <titop/analysis/certify/faults.hpp>
#include <titop/compiler/passes/check/springs.hpp>

/// The full certificate as text.
namespace titop {
namespace {

std::string at_s(std::complex<double> s) {
  return fmt::format("s = {:.3g}{:+.3g}j", s.real(), s.imag());
}

std::string to_string(const FullCertificate::Grid& g) {
  std::string text =
      fmt::format("grid of {} points, {:.3g} to {:.3g} rad/s: ", g.points, g.lowest, g.highest);
  text += g.done ? fmt::format("dense model equal to the factors to {:.1e} ({})", g.dense,
                               at_s(g.dense_s))
                 : "dense model not compared: " + g.why_not;
  if (g.done && !g.why_not.empty()) text += "; left out: " + g.why_not;
  text += g.written >= 0 ? fmt::format("; equations as written, solved at once, to {:.1e} ({})",
                                       g.written, at_s(g.written_s))
                         : "; equations as written not solved at once";
  return text + "\n";
}

std::string to_string(const FullCertificate::Poles& p) {
  if (!p.done) return "poles not checked: " + p.why_not + "\n";
  std::string text = fmt::format("{} poles, {} of them equal to the factors' to {:.1e}", p.count,
                                 p.measured, p.error);
  if (p.measured < p.count)
    text += fmt::format(", {} at 0 or ill-conditioned and not measured", p.count - p.measured);
  if (p.right > 0)
    text += fmt::format("; {} right of the axis, the worst {}", p.right, at_s(p.rightmost));
  else
    text += p.measured < p.count ? "; none of those measured right of the axis"
                                 : "; none right of the axis";
  if (!p.why_not.empty()) text += "; not counted: " + p.why_not;
  if (p.hidden > 0)
    text += fmt::format(
        "\nWARNING: {} right of the axis and in no transfer: no input moves {}, or no "
        "output sees {}",
        p.hidden == 1 ? "one pole is" : fmt::format("{} poles are", p.hidden),
        p.hidden == 1 ? "it" : "them", p.hidden == 1 ? "it" : "them");
  return text + "\n";
}

std::string to_string(const FullCertificate::Passivity& p) {
  if (!p.done) return "passivity not checked: " + p.why_not + "\n";
  return fmt::format(
      "{} pairs of a force and the acceleration where it acts: {} (least {:.1e} of 1, {})\n",
      p.pairs, p.least >= -certification::kPassive ? "passive at all points" : "not passive",
      p.least, at_s(p.where));
}

std::string to_string(const FullCertificate::Reciprocity& r) {
  if (!r.done) return "reciprocity not checked: " + r.why_not + "\n";
  std::string text =
      fmt::format("{} forces: {}", r.forces,
                  r.asymmetry <= certification::kHolds ? "reciprocal" : "not reciprocal");
  if (r.reversed) text += " if all momenta are reversed";
  if (!r.momenta.empty()) text += fmt::format(" ({})", passes::momenta_text(r.momenta));
  if (r.asymmetry > 0)
    text +=
        fmt::format(" (the accelerations at {} and {} due to the other force differ by {:.1e}, {})",
                    r.first, r.second, r.asymmetry, at_s(r.where));
  if (!r.structure) text += "; not required: " + r.why_no_structure;
  return text + "\n";
}

}  // namespace

std::string to_string(const FullCertificate& c) {
  std::string text = to_string(c.basic) + to_string(c.grid) + to_string(c.poles) +
                     to_string(c.passivity) + to_string(c.reciprocity) + to_string(c.order) + "\n" +
                     to_string(c.exact) + "\n";
  if (c.holds()) return text + "all checks that were made have passed\n";
  for (const std::string& fault : c.faults) text += "FAULT: " + fault + "\n";
  return text;
}

}  // namespace titop
