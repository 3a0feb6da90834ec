#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <titop/blocks/fe/import_options.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::fe {

void refuse_others(const ImportOptions& given, const TakenOptions& taken, const std::string& file) {
  std::string names;
  const auto refuse = [&](bool is_taken, bool is_given, const char* name) {
    if (!is_taken && is_given) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  const auto& [length, mass, time] = given.units;
  const ModeOptions& modes = given.modes;
  refuse(taken.ports, !given.parent.empty(), "parent (--parent)");
  refuse(taken.ports, !given.children.empty(), "children (--children)");
  refuse(taken.units, length != 1 || mass != 1 || time != 1, "units (--units)");
  refuse(taken.grids, !given.grids.empty(), "grids (--grids)");
  refuse(taken.matrices, !given.stiffness.empty() || !given.mass.empty(),
         "stiffness and mass (--matrices)");
  refuse(taken.modes, modes.kept.has_value() || !modes.residual.empty(),
         "modes.kept and residual (--modes)");
  refuse(taken.modes, modes.rayleigh.has_value(), "modes.rayleigh");
  refuse(taken.modes, modes.rigid.has_value(), "modes.rigid (--mass)");
  refuse(taken.xi, !modes.xi.empty(), "modes.xi (--xi)");
  if (names.empty()) return;
  throw Error(Code::bad_value, fmt::format("{} takes no {}", file, names),
              "leave it out: the data of the file itself decide (a CSV of modes has its own lines "
              "of units, damping and ports)");
}

std::pair<std::string, std::string> chosen_pair(const ImportOptions& options,
                                                const std::vector<std::string>& there,
                                                const std::string& file) {
  if (!options.stiffness.empty() || !options.mass.empty()) return {options.stiffness, options.mass};
  constexpr std::array<std::pair<const char*, const char*>, 5> pairs = {
      {{"KAA", "MAA"}, {"KXX", "MXX"}, {"KAAX", "MAAX"}, {"KGG", "MGG"}, {"K", "M"}}};
  const auto has = [&](const char* name) { return std::ranges::find(there, name) != there.end(); };
  std::vector<std::string> found;
  std::pair<std::string, std::string> result;
  for (const auto& [K, M] : pairs)
    if (has(K) && has(M)) {
      found.push_back(fmt::format("{} and {}", K, M));
      result = {K, M};
    }
  if (found.size() == 1) return result;
  throw Error(
      Code::unknown_name,
      fmt::format("{} has {} pair of stiffness and mass{}", file,
                  found.empty() ? "no" : "more than one",
                  found.empty() ? " that is known by name" : ""),
      fmt::format("name them (ImportOptions::stiffness, mass; titop import --matrices K,M); "
                  "its matrices are {}",
                  titop::detail::some_names(there)));
}

void set_damping(const std::vector<double>& xi, ModalData& data) {
  if (xi.empty()) return;
  if (xi.size() == 1) {
    data.xi.setConstant(xi[0]);
    return;
  }
  if (std::ssize(xi) != data.xi.size())
    throw Error(Code::size,
                fmt::format("{} damping ratios for {} modes", xi.size(), data.xi.size()),
                "one for all, or one per mode");
  data.xi = Eigen::Map<const Eigen::VectorXd>(xi.data(), std::ssize(xi));
}

}  // namespace titop::fe
