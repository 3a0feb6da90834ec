#include <fmt/format.h>

#include <titop/emit/text/literals.hpp>

#include "generate/generate.hpp"

namespace titop::generate {
namespace {

constexpr const char* kHead =
    R"(// Written by `titop generate`. Compares titop's model of
// {scene}
// with equations of motion that were assembled by hand. A program by itself; run
// it where the diagram file is.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <titop/titop.hpp>
#include <vector>

using Complex = std::complex<double>;

)";

constexpr const char* kAnswer = R"(namespace {{

/// Worst entry, relative to the geometric mean of the largest entries of its row and column; a row
/// or a column of nothing but zeros counts as large as the largest.
double error(const Eigen::MatrixXcd& G, const Eigen::MatrixXcd& exact) {{
  const double all = exact.cwiseAbs().maxCoeff();
  const auto or_all = [&](double size) {{ return size > 1e-12 * all ? size : all; }};
  double worst = 0;
  for (Eigen::Index i = 0; i < G.rows(); ++i)
    for (Eigen::Index j = 0; j < G.cols(); ++j) {{
      const double off = std::abs(G(i, j) - exact(i, j));
      const double size = std::sqrt(or_all(exact.row(i).cwiseAbs().maxCoeff())) *
                          std::sqrt(or_all(exact.col(j).cwiseAbs().maxCoeff()));
      if (!(off <= 0)) worst = std::max(worst, std::isfinite(off) ? off / size : HUGE_VAL);
    }}
  return worst;
}}

const std::vector<Complex> poles = {{{poles}}};  // with Im s >= 0

}}  // namespace

TEST_CASE({scene}) {{
  // The order is that of the minimal model, however many states there are; exact arithmetic for few,
  // as stiffnesses may be too far apart for double.
  const titop::System system = titop::compile(titop::read_diagram({scene}),
                                              {{.minimize_up_to = 1000000, .exact_up_to = 30}});
  const titop::OrderVerdict verdict = system.order_verdict();
  CHECK(verdict.lowest <= {order});
  if (verdict.decided()) {{  // else poles may be missing
    CHECK(verdict.highest == {order});
    std::vector<Complex> found;
    for (const titop::Pole& p : system.poles()) found.push_back(p.s);
    REQUIRE(found.size() == poles.size());
    for (const Complex& p : poles) {{
      const auto next = std::min_element(found.begin(), found.end(), [&](auto& a, auto& b) {{
        return std::abs(a - p) < std::abs(b - p);
      }});
      CHECK(std::abs(*next - p) <= 1e-6 * std::max(std::abs(p), 1e-3));
      found.erase(next);
    }}
  }}
{checks}}}
)";

constexpr const char* kCheck = R"(  {{
    Eigen::MatrixXcd exact({rows}, {cols});
    exact << {entries};
    CHECK(error(system.transfer({s}), exact) <= 1e-9);
    CHECK(error(system.state_space().transfer({s}), exact) <= 1e-7);
  }}
)";

constexpr const char* kRefused = R"(TEST_CASE({scene}) {{
  std::string said = "nothing";
  try {{
    titop::compile(titop::read_diagram({scene}));
  }} catch (const titop::Error& error) {{
    said = error.what();
  }}
  for (const char* part : {{{parts}}}) CHECK(said.find(part) != std::string::npos);
}}
)";

std::string complex(const Json& pair) {
  return fmt::format("Complex({}, {})", pair[0].dump(), pair[1].dump());
}

std::string list(const Json& pairs) {
  std::string all;
  for (const Json& p : pairs) all += (all.empty() ? "" : ", ") + complex(p);
  return all;
}

std::string check(const Json& point) {
  const Json& G = point["G"];
  if (G.empty() || G[0].empty()) return {};
  std::string entries;
  for (const Json& row : G) entries += (entries.empty() ? "" : ",\n        ") + list(row);
  return fmt::format(fmt::runtime(kCheck), fmt::arg("rows", G.size()),
                     fmt::arg("cols", G[0].size()), fmt::arg("entries", entries),
                     fmt::arg("s", complex(point["s"])));
}

}  // namespace

std::string test_source(const Generated& g, const std::string& scene_file) {
  const std::string scene = emit::quoted(scene_file);
  const std::string head = fmt::format(fmt::runtime(kHead), fmt::arg("scene", scene));
  if (g.answer.contains("refused")) {
    const Json& refused = g.answer["refused"];
    std::string parts = Json(fmt::format("error[{}]", refused["code"].get<std::string>())).dump();
    for (const Json& name : refused["names"]) parts += ", " + name.dump();
    return head +
           fmt::format(fmt::runtime(kRefused), fmt::arg("scene", scene), fmt::arg("parts", parts));
  }
  std::string checks;
  for (const Json& point : g.answer["transfer"]) checks += check(point);
  return head + fmt::format(fmt::runtime(kAnswer), fmt::arg("scene", scene),
                            fmt::arg("order", g.answer["order"].get<int>()),
                            fmt::arg("poles", list(g.answer["poles"])), fmt::arg("checks", checks));
}

}  // namespace titop::generate
