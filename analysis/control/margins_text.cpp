#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/control/margins.hpp>

namespace titop {
namespace {

std::string at(double omega) {
  return std::isinf(omega) ? "at high frequencies" : fmt::format("at {:.5g} rad/s", omega);
}

std::string gain_line(const char* name, const MarginAt& m, bool none) {
  return none ? fmt::format("  {:14}  none\n", name)
              : fmt::format("  {:14}  {:<10.5g}  {:+.2f} dB  {}\n", name, m.value,
                            decibels(m.value), at(m.omega));
}

std::string disk_text(const DiskMargin& d) {
  return fmt::format("  {:14}  {:<10.5g}  gains {:.4g} to {:.4g}, phase {:.2f} deg  {}\n", "disk",
                     d.alpha, d.least_gain(), d.largest_gain(), degrees(d.phase()), at(d.omega));
}

std::string nearest_text(const MarginAt& m) {
  return fmt::format("  {:14}  {:<10.5g}  {}\n", "nearest to -1", m.value, at(m.omega));
}

std::string text_of(const LoopMargins& m) {
  std::string text = fmt::format("{}\n", m.point);
  text += gain_line("larger gain", m.larger_gain, std::isinf(m.larger_gain.value));
  text += gain_line("smaller gain", m.smaller_gain, m.smaller_gain.value == 0);
  if (std::isinf(m.phase.value)) {
    text += fmt::format("  {:14}  none: |L| is not 1 at any frequency\n", "phase, delay");
  } else {
    text += fmt::format("  {:14}  {:<10.5g}  {:.2f} deg  {}\n", "phase [rad]", m.phase.value,
                        degrees(m.phase.value), at(m.phase.omega));
    text += fmt::format("  {:14}  {:<10.5g}  {}\n", "delay [s]", m.delay.value, at(m.delay.omega));
  }
  return text + disk_text(m.disk) + nearest_text(m.nearest);
}

std::string results(const Margins& m) {
  const NyquistCount& n = m.nyquist;
  if (!m.stable)
    return fmt::format(
        "the closed loop is not stable, and has no margins: {} poles right of the axis, {} on it "
        "up "
        "to rounding (L has {} poles right of it; encirclements of -1: {}{})\n",
        n.closed_right, n.closed_on_axis, n.open_right, n.encirclements,
        n.agree || n.closed_on_axis > 0 ? "" : ", which does not agree");
  std::string text = fmt::format(
      "stable: no closed-loop pole right of the axis (L has {}; encirclements of -1: {})\n",
      n.open_right, n.encirclements);
  if (m.loops.size() > 1)
    text += "all loops at once\n" + disk_text(m.disk) + nearest_text(m.nearest);
  for (const LoopMargins& one : m.loops) text += text_of(one);
  return text;
}

}  // namespace

std::string to_string(const Margins& m) {
  std::string text = results(m);
  for (const std::string& w : m.warnings) text += fmt::format("warning of L: {}\n", w);
  return text;
}

}  // namespace titop
