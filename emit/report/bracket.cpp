#include <algorithm>
#include <numbers>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/subject.hpp>

namespace titop::report {
namespace {

using Interval = InterfaceBracket::Interval;

double relative(const Interval& i) { return i.above > 0 ? i.width() / i.above : 0; }

std::string percent(double share) { return number(100 * share, 2) + " %"; }

/// One line per interval, in this unit.
std::string table_of(const std::vector<Interval>& list, const char* subject, const char* unit,
                     double of_unit) {
  if (list.empty()) return {};
  const std::vector<std::string> classes = {"n", "n", "n", "n"};
  std::string text =
      "<div class=\"table\"><table>\n" +
      row({subject, fmt::format("at least [{}]", unit), fmt::format("at most [{}]", unit), "width"},
          classes, "th");
  for (std::size_t k = 0; k < list.size(); ++k)
    text += row({fmt::format("{}", k + 1), number(list[k].below / of_unit, 6),
                 number(list[k].above / of_unit, 6), percent(relative(list[k]))},
                classes);
  return text + "</table></div>\n";
}

double widest(const std::vector<Interval>& list) {
  double width = 0;
  for (const Interval& i : list) width = std::max(width, relative(i));
  return width;
}

}  // namespace

std::string bracket_section(const Subject& s) {
  if (!s.options.bracket) return {};
  const InterfaceBracket& b = *s.options.bracket;
  std::string text;
  if (!b.omega.empty())
    text += fmt::format(
        "<p>Lumping of the interfaces moves none of the first {} frequencies by more than "
        "<b>{}</b>: if every node is joined by itself, each frequency lies between that of "
        "released "
        "interfaces (averages, moments) and that of constrained ones (rigid, shapes), without "
        "damping (Courant's theorem).</p>\n",
        b.omega.size(), percent(widest(b.omega)));
  text += table_of(b.omega, "mode", "Hz", 2 * std::numbers::pi);
  if (!b.compliance.empty())
    text +=
        "<p>Static compliances lie between those of constrained and of released "
        "interfaces.</p>\n" +
        table_of(b.compliance, "pair", "SI", 1);
  if (b.transfer_difference > 0)
    text += fmt::format(
        "<p>The transfers of both differ by {} of an entry's largest value at the chosen "
        "frequencies: an estimate, no bound.</p>\n",
        percent(b.transfer_difference));
  return text;
}

}  // namespace titop::report
