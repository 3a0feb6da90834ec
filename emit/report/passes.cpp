#include <fmt/format.h>

#include <algorithm>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>

namespace titop::report {
namespace {

std::string promise(const std::string& name) {
  for (const CompilerPass& pass : compiler_passes())
    if (pass.name == name) return pass.promise;
  return {};
}

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
      if (n.pass == pass)
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
  for (const auto& of_dense : s.system.dense_seconds()) times.push_back(of_dense);
  double all = 0, longest = 0;
  for (const auto& [pass, t] : times) all += t, longest = std::max(longest, t);
  std::string text =
      "<div class=\"table\"><table class=\"passes\">\n<thead>" +
      row({"pass", "property afterwards", "result", "time", ""}, {"", "", "", "n", ""}, "th") +
      "</thead>\n<tbody>\n";
  for (const auto& [pass, t] : times)
    text += row({diagram::html(pass), escaped(promise(pass)), notes(s, pass), duration(t),
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
