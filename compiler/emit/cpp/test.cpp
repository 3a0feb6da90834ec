#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/emit/cpp/test.hpp>
#include <titop/compiler/emit/cpp/test_source.hpp>
#include <titop/compiler/emit/cpp/text.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::emit {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

std::string tolerance(double least, double measured) {
  return fmt::format("{:.1e}", std::max(least, 10 * measured));
}

std::string pair(double re, double im) { return fmt::format("{{{}, {}}}", number(re), number(im)); }

/// Complex values by columns, as an initializer.
std::string values(const Eigen::MatrixXcd& G) {
  std::vector<std::string> items;
  for (Index j = 0; j < G.cols(); ++j)
    for (Index i = 0; i < G.rows(); ++i) items.push_back(pair(G(i, j).real(), G(i, j).imag()));
  return list(items, 6);
}

std::string indices(const std::vector<Index>& list) {
  std::vector<std::string> items;
  for (const Index i : list) items.push_back(std::to_string(i));
  return emit::list(items, 6);
}

std::string transfer_checks(const Points& points) {
  // A file of some megabytes is still compiled in seconds.
  const auto entries = static_cast<std::size_t>(points.exact[0].size());
  const std::size_t count = std::clamp<std::size_t>(40000 / entries, 2, points.s.size());
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = i * (points.s.size() - 1) / (count - 1);
    text += fmt::format(
        "  {{\n    static const double expected[][2] = {};\n"
        "    CHECK(transfer_error({}, expected) <= tolerance);\n  }}\n",
        values(points.exact[k]), pair(points.s[k].real(), points.s[k].imag()));
  }
  return text;
}

/// Poles other than 0, so many of them that the test takes seconds.
std::vector<std::string> poles_to_find(const std::vector<Pole>& poles, Index n) {
  std::vector<std::string> moving, chosen;
  for (std::size_t k = 0; k < poles.size(); ++k)
    if (poles[k].omega > 0) moving.push_back(std::to_string(k));
  const double affordable = 2e9 / std::max(1.0, std::pow(double(n), 3));
  const auto count = static_cast<std::size_t>(std::clamp(affordable, 2.0, 60.0));
  if (moving.size() <= count) return moving;
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(moving[i * (moving.size() - 1) / (count - 1)]);
  return chosen;
}

/// Largest distance of a pole other than 0 to the eigenvalues that double finds in A.
double pole_error(const std::vector<Pole>& poles, const MatrixXd& A) {
  const Eigen::VectorXcd found = linalg::eigenvalues(A);
  double worst = 0;
  for (const Pole& p : poles)
    if (p.omega > 0) worst = std::max(worst, (found.array() - p.s).abs().minCoeff() / p.omega);
  return worst;
}

std::string pole_test(const Naming& names, const Form& form, const std::vector<Pole>& poles) {
  std::vector<std::string> items;
  for (const Pole& p : poles) items.push_back(pair(p.s.real(), p.s.imag()));
  return filled(kPoles, {{"NAME", names.name},
                         {"POLES", list(items, 4)},
                         {"WHICH", list(poles_to_find(poles, form.A.rows()), 6)},
                         {"TOLERANCE", tolerance(1e-9, pole_error(poles, form.A))}});
}

std::string trajectory_test(const Naming& names, const Form& form, const MatrixXd& outputs) {
  std::vector<std::string> rows;
  for (Index k = 0; k < outputs.cols(); ++k) rows.push_back("\n      " + list(outputs.col(k), 7));
  std::string all;
  for (const std::string& row : rows) all += (all.empty() ? "{" : ",") + row;
  return filled(kTrajectory, {{"NAME", names.name},
                              {"NY", std::to_string(names.outputs.size())},
                              {"VALUES", all + "}"},
                              {"STEPS", std::to_string(outputs.cols())},
                              {"TOLERANCE", tolerance(1e-11, form.step_error)}});
}

/// Nothing where the series would take more than some seconds.
std::string taylor_test(const Naming& names, const Form& form, const std::vector<Pole>& poles) {
  double fastest = 0;
  for (const Pole& p : poles) fastest = std::max(fastest, p.omega);
  const double parts = std::max(1.0, std::ceil(fastest * names.sample_time));
  if (72 * parts * static_cast<double>(products(form)) > 1e9) return {};
  return filled(kTaylor, {{"NAME", names.name},
                          {"NY", std::to_string(names.outputs.size())},
                          {"SUBSTEPS", fmt::format("{:.0f}", parts)}});
}

}  // namespace

std::string test_text(const Naming& names, const Form& form, const Expected& expected) {
  const std::string states = std::to_string(names.states.size());
  std::string text = filled(kHead, {{"DIAGRAM", quoted(names.diagram)},
                                    {"NAME", names.name},
                                    {"N", states},
                                    {"NU", std::to_string(names.inputs.size())},
                                    {"NY", std::to_string(names.outputs.size())}});
  const bool responds = !names.inputs.empty() && !names.outputs.empty();
  if (responds)
    text += filled(kTransfer, {{"NAME", names.name},
                               {"TOLERANCE", tolerance(1e-11, form.error)},
                               {"SILENT_OUTPUTS", indices(expected.points.silent_outputs)},
                               {"SILENT_INPUTS", indices(expected.points.silent_inputs)},
                               {"CHECKS", transfer_checks(expected.points)}});
  if (!names.states.empty()) text += pole_test(names, form, expected.poles);
  if (responds && expected.static_gain)
    text +=
        filled(kStaticGain, {{"NAME", names.name},
                             {"VALUES", values(expected.static_gain->cast<std::complex<double>>())},
                             {"TOLERANCE", tolerance(1e-11, form.static_error)}});
  if (names.sample_time > 0 && responds) {
    text += trajectory_test(names, form, expected.outputs);
    text += taylor_test(names, form, expected.poles);
  }
  return text;
}

}  // namespace titop::emit
