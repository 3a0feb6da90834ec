#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>

namespace titop::report {
namespace {

/// State of the diagram after each pass, for readers without the manual.
struct Promise {
  std::string_view pass, text;
};
constexpr Promise kPromises[] = {
    {"check", "sizes, quantities and frames agree; each channel is driven once"},
    {"lower", "sums, gains and rotations are coefficients of equations"},
    {"split", "parts without output are set aside"},
    {"chains", "closed chains meet; redundant loop constraints are released"},
    {"match", "every row has its unknown; channel inversions are known"},
    {"order", "algebraic loops are known; unreachable and unobservable signals are set aside"},
    {"close", "dependent states are known and eliminated"},
    {"solve", "all interface unknowns, junction by junction: the factored system"},
    {"certify", "the checks and their residuals"},
    {"minimize", "A, B, C, D written from the factors; modes without effect are removed"},
};

std::string promise(const std::string& pass) {
  for (const Promise& p : kPromises)
    if (p.pass == pass) return std::string(p.text);
  return {};
}

/// Asking for a dense model that is there already takes less [s].
constexpr double kLook = 1e-5;

std::string duration(double seconds) {
  return seconds < 1e-3 ? fmt::format("{:.0f} µs", 1e6 * seconds)
         : seconds < 1  ? fmt::format("{:.3g} ms", 1e3 * seconds)
                        : fmt::format("{:.3g} s", seconds);
}

std::string notes(const Subject& s, const std::string& pass) {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> lines;
  for (const auto& list : {s.system.notes(), s.system.dense_notes()})
    for (const Note& n : list)
      if (n.pass == pass || (n.pass == "dense" && pass == "minimize"))
        lines.push_back(n.kind == Note::Kind::info
                            ? escaped(n.text)
                            : fmt::format("<b>{}</b> {}", to_string(n.kind), escaped(n.text)));
  const std::size_t all = lines.size();
  if (all > kShown) {
    lines.resize(kShown);
    lines.push_back(fmt::format("and {} more", all - kShown));
  }
  return fmt::format("{}", fmt::join(lines, "<br/>"));
}

}  // namespace

std::string passes_section(const Subject& s, const FullCertificate* full) {
  auto times = s.system.seconds();
  times.emplace_back("minimize", s.dense_seconds);
  double all = 0, longest = 0;
  for (const auto& [pass, t] : times) all += t, longest = std::max(longest, t);
  std::string text =
      "<div class=\"table\"><table class=\"passes\">\n<thead>" +
      row({"pass", "promise afterwards", "what it did", "time", ""}, {"", "", "", "n", ""}, "th") +
      "</thead>\n<tbody>\n";
  for (const auto& [pass, t] : times)
    text += row({diagram::html(pass), escaped(promise(pass)), notes(s, pass),
                 pass == "minimize" && t < kLook ? "made before" : duration(t),
                 fmt::format(R"(<i class="bar" style="width:{:.0f}px"></i>)",
                             longest > 0 ? 80 * t / longest : 0)},
                {"name fit", "", "wide", "n", "fit"});
  text += row({"", "", "all together", duration(all), ""}, {"", "", "", "n", ""});
  text += "</tbody></table></div>\n";
  if (full)
    text +=
        "<p class=\"note\">The full certificate and the responses above were made for this "
        "report and are not in these times.</p>\n";
  return text;
}

}  // namespace titop::report
