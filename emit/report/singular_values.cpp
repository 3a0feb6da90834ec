#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows (or columns) of one unit, which may be added as vectors.
struct Alike {
  std::string unit, names;
  std::vector<int> at;
};

std::vector<Alike> alike(const std::vector<UnitGroup>& groups) {
  std::vector<Alike> list;
  for (const UnitGroup& g : groups) {
    const auto fits = [&](const Alike& a) {
      return a.unit == g.unit && (!g.unit.empty() || a.names == g.signal);
    };
    auto found = std::find_if(list.begin(), list.end(), fits);
    if (found == list.end()) found = list.insert(list.end(), {g.unit, {}, {}});
    if (found->names != g.signal && !found->names.ends_with(", " + g.signal))
      found->names += (found->names.empty() ? "" : ", ") + g.signal;
    found->at.insert(found->at.end(), g.at.begin(), g.at.end());
  }
  return list;
}

std::string shortened(const std::string& names) {
  return names.size() <= 60 ? names : names.substr(0, names.rfind(',', 50)) + ", …";
}

/// Singular values, largest first: the eigenvalues of [0 G; G* 0] in real form, each twice there
/// with either sign; accurate to rounding of the largest.
VectorXd singular_values_of(const MatrixXcd& G) {
  const Index m = G.rows(), n = G.cols(), k = m + n;
  MatrixXd H = MatrixXd::Zero(2 * k, 2 * k);
  H.block(m, 0, n, m) = H.block(k + m, k, n, m) = G.real().transpose();
  H.block(k, m, m, n) = G.imag();
  H.block(k + m, 0, n, m) = -G.imag().transpose();
  const VectorXd values = eigh(H).lambda;
  VectorXd sigma(std::min(m, n));
  for (Index i = 0; i < sigma.size(); ++i) sigma(i) = std::max(0.0, values(2 * k - 1 - 2 * i));
  return sigma;
}

/// Removes the last curves that are at rounding level.
void drop_zero(std::vector<std::vector<double>>& curves) {
  const auto peak = [](const std::vector<double>& curve) {
    double largest = 0;
    for (const double v : curve)
      if (std::isfinite(v)) largest = std::max(largest, v);
    return largest;
  };
  constexpr double kNothing = 1e-11;  // of an eigenproblem whose entries have twelve digits
  const double largest = peak(curves.front());
  while (!curves.empty() && peak(curves.back()) <= kNothing * largest) curves.pop_back();
}

/// None if all are zero.
std::optional<Plot> singular_values(const Sweep& w, const Alike& outputs, const Alike& inputs) {
  const std::size_t count = std::min({outputs.at.size(), inputs.at.size(), kStyles});
  std::vector<std::vector<double>> curves(count);
  for (const MatrixXcd& G : w.G) {
    VectorXd sigma = VectorXd::Constant(static_cast<Index>(count), kNone);
    if (G.size()) sigma = singular_values_of(G(outputs.at, inputs.at));
    for (std::size_t k = 0; k < count; ++k) curves[k].push_back(sigma(static_cast<Index>(k)));
  }
  drop_zero(curves);
  if (curves.empty()) return {};
  const std::string caption = curves.size() == count ? "" : "All others are zero to rounding.";
  Plot plot{
      .title = fmt::format("{} [{}] from {} [{}]", shortened(outputs.names), or_users(outputs.unit),
                           shortened(inputs.names), or_users(inputs.unit)),
      .caption = caption,
      .x = {.label = "frequency", .unit = "Hz", .log = true},
      .labels = {},
      .x_data = {curves.size(), w.hertz},
      .frames = {
          {.y = {.label = "singular values", .unit = ratio(outputs.unit, inputs.unit), .log = true},
           .curves = {},
           .height = 200}}};
  plot.x.low = w.hertz.front(), plot.x.high = w.hertz.back();
  for (std::size_t k = 0; k < curves.size(); ++k) plot.labels.push_back(fmt::format("σ{}", k + 1));
  plot.labels.front() += curves.size() > 1 ? " (largest)" : " (largest gain)";
  plot.frames.front().curves = std::move(curves);
  return plot;
}

}  // namespace

std::optional<Plot> sigma_plot(const Sweep& w, const std::vector<UnitGroup>& outputs,
                               const std::vector<UnitGroup>& inputs) {
  Alike out, in;
  for (const UnitGroup& g : outputs) out.at.insert(out.at.end(), g.at.begin(), g.at.end());
  for (const UnitGroup& g : inputs) in.at.insert(in.at.end(), g.at.begin(), g.at.end());
  out.names = "all outputs", in.names = "all inputs";
  return singular_values(w, out, in);
}

std::string singular_value_plots(const Sweep& w, const std::vector<UnitGroup>& outputs,
                                 const std::vector<UnitGroup>& inputs) {
  std::string figures;
  std::size_t number = 0;
  for (const Alike& in : alike(inputs))
    for (const Alike& out : alike(outputs)) {
      if (in.at.size() * out.at.size() == 1) continue;
      std::optional<Plot> one;
      if (number < kFigures) one = singular_values(w, out, in);
      if (one || number >= kFigures) ++number;
      if (one) figures += figure(*one);
    }
  if (figures.empty()) return {};
  const std::string text =
      "<h3>Singular values</h3>\n<p>The gain from a vector of inputs to a vector of outputs lies "
      "between the largest and the smallest; inputs and outputs of one unit are taken "
      "together.</p>\n<div class=\"figures\">\n";
  return text + figures + "</div>\n" + left_out(number, "compile for fewer inputs or outputs");
}

}  // namespace titop::report
