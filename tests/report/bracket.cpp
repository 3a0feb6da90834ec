// The report's section on interfaces of many nodes.
#include <doctest/doctest.h>

#include <numbers>
#include <titop/titop.hpp>

#include "markup.hpp"

using namespace titop;
using namespace titop_test;

namespace {

Diagram spring() {
  Diagram d{"spring"};
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 100});
  z.parent.accel = 0;
  z.child.force = d.input("F");
  d.output("x") = z.stretch;
  return d;
}

std::string section_of(const std::optional<InterfaceBracket>& bracket) {
  const std::string html = report_html(compile(spring()), {.diagrams = false, .bracket = bracket});
  CHECK(complaint(html) == "");
  const std::size_t at = html.find("<section id=\"interfaces\">");
  return at == std::string::npos ? "" : html.substr(at, html.find("</section>", at) - at);
}

}  // namespace

TEST_CASE("report: how much the lumping of interfaces costs, mode by mode and as one number") {
  const double hertz = 2 * std::numbers::pi;
  const InterfaceBracket b{.omega = {{9.9 * hertz, 10 * hertz}, {19 * hertz, 20 * hertz}},
                           .compliance = {{0.002, 0.0025}},
                           .transfer_difference = 0.125};
  const std::string section = section_of(b);
  for (const char* text : {"first 2 frequencies", "<b>5 %</b>", ">9.9<", ">10<", ">1 %<", ">19<",
                           ">20<", ">5 %<", "0.002", "0.0025", ">20 %<", "12 %", "estimate"})
    CHECK_MESSAGE(section.find(text) != std::string::npos, text);
  CHECK(between(section, "<table>", "</table>").size() == 2);
}

TEST_CASE("report: no bracket, no section") { CHECK(section_of({}).empty()); }
