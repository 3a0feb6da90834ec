#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <titop/emit/report/pairs.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::report {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

/// Largest magnitudes over the sweep, outputs x inputs.
MatrixXd peaks(const Subject& s, const Sweep& w) {
  MatrixXd peak =
      MatrixXd::Zero(static_cast<Index>(s.outputs.size()), static_cast<Index>(s.inputs.size()));
  for (const MatrixXcd& G : w.G)
    if (G.size()) peak = peak.cwiseMax(G.cwiseAbs());
  return peak;
}

template <class List>
int group_of(const List& groups, int scalar) {
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const int i : groups[g].at)
      if (i == scalar) return static_cast<int>(g);
  return 0;
}

int find(const std::vector<ScalarSignal>& list, const std::string& name, const char* subject) {
  std::string known;
  for (const ScalarSignal& s : list) {
    if (s.name == name) return s.index;
    if (s.index < 20) known += (known.empty() ? "" : ", ") + s.name;
  }
  throw Error(Code::unknown_name,
              fmt::format("ReportOptions::pairs: there is no {} \"{}\"", subject, name),
              fmt::format("{}s are: {}", subject, known));
}

}  // namespace

std::vector<IoPair> strongest(const Subject& s, const Sweep& sweep,
                              const std::vector<UnitGroup>& outputs,
                              const std::vector<UnitGroup>& inputs) {
  constexpr double kNothing = 1e-12;  // of the row's and column's peaks: rounding of a transfer
  const MatrixXd peak = peaks(s, sweep);
  std::vector<IoPair> list;
  for (std::size_t a = 0; a < inputs.size(); ++a)
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      IoPair best{outputs[b].at.front(), inputs[a].at.front(), static_cast<int>(b),
                  static_cast<int>(a)};
      for (const int i : outputs[b].at)
        for (const int j : inputs[a].at)
          if (peak(i, j) > peak(best.output, best.input)) best.output = i, best.input = j;
      const double usual =
          std::sqrt(peak.row(best.output).maxCoeff()) * std::sqrt(peak.col(best.input).maxCoeff());
      if (peak(best.output, best.input) > kNothing * usual) list.push_back(best);
    }
  return list;
}

std::vector<IoPair> asked(const Subject& s, const std::vector<UnitGroup>& outputs,
                          const std::vector<UnitGroup>& inputs) {
  std::vector<IoPair> list;
  for (const auto& [output, input] : s.options.pairs) {
    IoPair p{find(s.outputs, output, "output"), find(s.inputs, input, "input"), 0, 0};
    p.output_group = group_of(outputs, p.output);
    p.input_group = group_of(inputs, p.input);
    list.push_back(p);
  }
  return list;
}

std::vector<std::vector<IoPair>> by_figure(const Subject& s, const std::vector<IoPair>& pairs) {
  std::vector<std::vector<IoPair>> together, figures;
  std::map<std::pair<int, std::string>, std::size_t> found;
  for (const IoPair& p : pairs) {
    const auto key = std::pair(p.input_group, s.outputs[at(p.output)].unit);
    const auto [place, is_new] = found.emplace(key, together.size());
    if (is_new) together.emplace_back();
    together[place->second].push_back(p);
  }
  for (const auto& list : together) {
    const std::size_t parts = (list.size() + kCurves - 1) / kCurves;
    for (std::size_t i = 0; i < parts; ++i)
      figures.emplace_back(list.begin() + static_cast<Index>(i * list.size() / parts),
                           list.begin() + static_cast<Index>((i + 1) * list.size() / parts));
  }
  return figures;
}

std::string left_out(std::size_t figures, const char* way_out) {
  if (figures <= kFigures) return {};
  return fmt::format("<p class=\"note\">{} more figures are left out; {}.</p>\n",
                     figures - kFigures, way_out);
}

}  // namespace titop::report
