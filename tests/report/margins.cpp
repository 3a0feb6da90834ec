// The report's section on margins.
#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "markup.hpp"

using namespace titop;
using namespace titop_test;

namespace {

/// L = K / (s (s + 1)^2) at the loop point "a < b", and a free second loop L = 1 / s.
std::string report_of(double K, bool with_point = true) {
  Diagram d{"loops"};
  auto plant =
      d.add("plant", Lti{.A = (Eigen::Matrix3d() << -1, 1, 0, 0, -1, 1, 0, 0, 0).finished(),
                         .B = Eigen::Vector3d(0, 0, 1),
                         .C = Eigen::RowVector3d(1, 0, 0)});
  auto r = d.input("r");
  plant.in = with_point ? r - d.loop_point("a < b", K * plant.out) : r - K * plant.out;
  d.output("y") = plant.out;
  return report_html(compile(d), {.diagrams = false});
}

std::string section_of(const std::string& html) {
  const std::size_t at = html.find("<section id=\"margins\">");
  if (at == std::string::npos) return {};
  return html.substr(at, html.find("</section>", at) - at);
}

}  // namespace

TEST_CASE("report: margins of a loop point, by hand, with its Nyquist curve") {
  const std::string html = report_of(1), section = section_of(html);
  CHECK(complaint(html) == "");
  CHECK(html.find("<a href=\"#margins\">") != std::string::npos);
  CHECK(section.find("a &lt; b") != std::string::npos);
  // arg L = -180 degrees at 1 rad/s, where |L| = 1/2.
  CHECK(section.find("+6.02 dB at 0.1592 Hz") != std::string::npos);
  // |L| = 1 where w (w^2 + 1) = 1: Cardano.
  const double root = std::sqrt(0.25 + 1.0 / 27);
  const double w = std::cbrt(0.5 + root) + std::cbrt(0.5 - root);
  const double phase = 90 - 2 * std::atan(w) * 180 / std::acos(-1.0);
  CHECK(section.find(fmt::format("{:.1f}° at", phase)) != std::string::npos);
  CHECK(between(section, "<figure", "</figure>").size() == 1);
}

TEST_CASE("report: an unstable loop has no margins; without a loop point there is no section") {
  const std::string html = report_of(3), section = section_of(html);
  CHECK(complaint(html) == "");
  CHECK(section.find("<li class=\"bad\">") != std::string::npos);
  CHECK(section.find(" dB ") == std::string::npos);
  CHECK(section_of(report_of(1, false)).empty());
}
