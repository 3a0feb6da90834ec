#include <fmt/format.h>

#include <algorithm>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::report {
namespace {

constexpr std::size_t kListed = 60, kFolded = 400;     ///< poles at once, and behind them
constexpr std::size_t kFew = 36, kSlowestOfMany = 24;  ///< at once, without a band

/// How many of the slowest poles are listed at once: those up to the band's upper end, at most 60.
std::size_t poles_listed(const Subject& s) {
  const double high = s.options.band_hz[1];
  const auto beyond =
      std::find_if(s.poles.begin(), s.poles.end(), [&](const Pole& p) { return p.hertz > high; });
  const auto in_band = static_cast<std::size_t>(beyond - s.poles.begin());
  if (high > 0) return std::min(in_band, kListed);
  return s.poles.size() <= kFew ? s.poles.size() : kSlowestOfMany;
}

std::string pole_table(const Subject& s, std::size_t begin, std::size_t end) {
  std::string text = "<div class=\"table\"><table class=\"poles\">\n<thead>" +
                     row({"", "frequency [Hz]", "[rad/s]", "damping [%]", "real part [1/s]",
                          "blocks that take part"},
                         {"n", "n", "n", "n", "n", "wide"}, "th") +
                     "</thead>\n<tbody>\n";
  for (std::size_t i = begin; i < end; ++i) {
    const Pole& p = s.poles[i];
    std::string shares;
    for (const auto& [name, share] : p.blocks)
      shares += fmt::format(
          R"(<span class="share"><i class="bar" style="width:{:.0f}px"></i>{} {:.0f} %</span> )",
          60 * share, diagram::html(name), 100 * share);
    if (p.unlike_bodies()) shares += fmt::format("(bodies: xi {})", xi_of_bodies(p));
    text += row(
        {fmt::format("{}{}", i + 1, p.pair ? "" : " (real)"), number(p.hertz, 6),
         number(p.omega, 6), p.omega > 0 ? number(100 * p.damping, 4) : "–", number(p.s.real(), 4),
         shares},
        {"n", "n", "n", "n", p.s.real() > linalg::kPoleOnAxis * p.omega ? "n bad" : "n", "wide"});
  }
  return text + "</tbody></table></div>\n";
}

}  // namespace

std::string poles_section(const Subject& s) {
  int gone = 0;
  for (const JudgedMode& m : s.system.order_verdict().removed) gone += m.states;
  const std::string left_out =
      gone == 0 ? ""
                : fmt::format(
                      "<p>The model is without {} that no transfer shows (see <a "
                      "href=\"#order\">Order</a>): their poles are not listed here.</p>\n",
                      count(static_cast<std::size_t>(gone), "state"));
  if (s.poles.empty())
    return "<p>The model has no states: outputs follow inputs at once.</p>\n" + left_out;
  const std::size_t listed = poles_listed(s), folded = std::min(s.poles.size(), listed + kFolded);
  std::string text = left_out +
                     "<p>One line per pole, or per pair of conjugate poles; slow ones first. "
                     "Participation factors are summed over the states of each block, down to 5 "
                     "%.</p>\n" +
                     (listed > 0 ? pole_table(s, 0, listed) : "<p>None in the band.</p>\n");
  if (folded > listed)
    text += fmt::format("<details><summary>{} more, {} to {} Hz</summary>\n{}</details>\n",
                        folded - listed, number(s.poles[listed].hertz),
                        number(s.poles[folded - 1].hertz), pole_table(s, listed, folded));
  if (s.poles.size() > folded)
    text += fmt::format("<p class=\"note\">{} more poles are not listed.</p>\n",
                        s.poles.size() - folded);
  return text;
}

}  // namespace titop::report
