#include <fmt/format.h>

#include <optional>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/report.hpp>
#include <titop/emit/report/subject.hpp>
#include <titop/emit/text/write_file.hpp>

namespace titop {

namespace {

struct ReportSection {
  const char *id, *title;
  std::string html;
};

std::string names_of_states(const System& system) {
  constexpr std::size_t kShown = 400;
  const auto& states = system.state_space().states;
  std::string text =
      "<p>Names of the states, in the model's order.</p>\n<ul class=\"columns name\">\n";
  for (std::size_t i = 0; i < states.size() && i < kShown; ++i)
    text += fmt::format("<li>{}</li>\n", diagram::html(states[i]));
  text += "</ul>\n";
  if (states.empty()) return "<p>The model has no states.</p>\n";
  if (states.size() > kShown)
    text += fmt::format("<p class=\"note\">{} more are not listed.</p>\n", states.size() - kShown);
  return text;
}

}  // namespace

std::string report_html(const System& system, const ReportOptions& options) {
  const report::Subject s = report::subject(system, options);
  std::optional<FullCertificate> full;
  if (system.order() <= options.full_up_to) full = certify(system, Full{});
  const FullCertificate* checked = full ? &*full : nullptr;
  report::Responses responses = report::responses(s);
  std::vector<ReportSection> sections = {
      {"scene", "The scene", report::scene_section(s)},
      {"poles", "Poles", report::poles_section(s)},
      {"modes", "Mode shapes", report::modes_section(s)},
      {"interfaces", "Interfaces of many nodes", report::bracket_section(s)},
      {"frequency", "Frequency responses", std::move(responses.frequency)},
      {"time", "Step responses", std::move(responses.time)},
      {"margins", "Stability margins", report::margins_section(s)},
      {"certificate", "Certificate", report::certificate_section(s, checked)},
      {"order", "Order, and removed states", report::order_section(s, checked)},
      {"passes", "Passes", report::passes_section(s, checked)},
      {"states", "States", names_of_states(system)},
  };
  std::erase_if(sections, [](const ReportSection& section) { return section.html.empty(); });
  const std::string title = options.title.empty() ? system.stage().graph.name : options.title;
  std::string body = fmt::format(
      "<header>\n<h1>{}</h1>\n<p class=\"about\">Compiled model of the "
      "scene “{}”, by titop</p>\n",
      diagram::html(title), report::escaped(system.stage().graph.name));
  if (!options.remark.empty())
    body += fmt::format("<p class=\"remark\">{}</p>\n", report::escaped_lines(options.remark));
  body += "<nav>\n";
  for (const ReportSection& section : sections)
    body += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, section.title);
  body += "</nav>\n</header>\n" + report::summary(s, checked);
  for (const ReportSection& section : sections)
    body += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", section.id,
                        section.title, section.html);
  return report::page(title, body);
}

void write_report(const System& system, const std::filesystem::path& file,
                  const ReportOptions& options) {
  emit::write_file(file, report_html(system, options));
}

}  // namespace titop
