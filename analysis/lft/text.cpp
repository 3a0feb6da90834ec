#include <fmt/format.h>

#include <algorithm>
#include <titop/analysis/lft/lft.hpp>

namespace titop {
namespace {

std::string verdict(const Lft& f, const Delta& d) {
  if (!f.not_decided().empty()) return "not decided";
  return d.minimal() ? "minimal" : fmt::format("at least {}", d.at_least);
}

}  // namespace

std::string to_string(const Lft& f) {
  const int n = f.m().order();
  std::string text = fmt::format(
      "{} state{}{}, {} occurrence{} of {} parameter{}\n", n, n == 1 ? "" : "s",
      f.states_at_least() == n && n > 0 ? " (minimal)" : "", f.occurrences(),
      f.occurrences() == 1 ? "" : "s", f.deltas().size(), f.deltas().size() == 1 ? "" : "s");
  std::size_t width = 4;
  for (const Delta& d : f.deltas()) width = std::max(width, d.parameter.size());
  for (const Delta& d : f.deltas()) {
    text += fmt::format("  {:<{}} {:>4}  {:<12} {:.6g} .. {:.6g}, delta = {}", d.parameter, width,
                        d.size, verdict(f, d), d.map.from, d.map.to, to_string(d.map, d.parameter));
    for (std::size_t i = 0; i < d.where.size(); ++i) text += (i == 0 ? "; in " : ", ") + d.where[i];
    text += "\n";
  }
  if (!f.not_decided().empty()) text += "  lower bounds: not decided, " + f.not_decided() + "\n";
  return text;
}

}  // namespace titop
