#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/fe/mode_damping.hpp>
#include <titop/graph/error.hpp>

namespace titop::fe {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd by_rayleigh(const Mesh& mesh, const Rayleigh& rayleigh, const VectorXd& omega) {
  const auto require = [&](double value, const char* name, const char* unit) {
    if (!(value >= 0) || !std::isfinite(value))
      throw Error(
          Code::bad_value,
          fmt::format("Rayleigh damping of mesh {} has {} {} {}", mesh.name, name, value, unit),
          "give numbers >= 0: the damping matrix is mass M + stiffness K");
  };
  require(rayleigh.mass, "mass", "1/s");
  require(rayleigh.stiffness, "stiffness", "s");
  return (rayleigh.mass * omega.cwiseInverse() + rayleigh.stiffness * omega) / 2;
}

}  // namespace

VectorXd damping_ratios(const Mesh& mesh, const ModeOptions& options, Index kept,
                        const VectorXd& omega) {
  const std::vector<double>& xi = options.xi;
  const Index total = omega.size();
  if (options.rayleigh && !xi.empty())
    throw Error(Code::bad_value,
                fmt::format("mesh {} is given damping ratios and Rayleigh damping", mesh.name),
                "give one of them: ModeOptions::xi or ModeOptions::rayleigh");
  if (options.rayleigh) return by_rayleigh(mesh, *options.rayleigh, omega);
  for (const double x : xi)
    if (!(x >= 0) || !std::isfinite(x))
      throw Error(Code::bad_value,
                  fmt::format("damping ratio {} of mesh {} is not a number >= 0", x, mesh.name),
                  "give fractions of critical damping: 0.005 is half a percent");
  const auto given = static_cast<Index>(xi.size());
  if (given == 0) return VectorXd::Zero(total);
  if (given != 1 && given != kept && given != total)
    throw Error(Code::size,
                fmt::format("{} damping ratios given for mesh {}, which has {} kept modes and {} "
                            "residual vectors",
                            given, mesh.name, kept, total - kept),
                "give one for all, one per kept mode, or one for each including the residual "
                "vectors");
  VectorXd result = VectorXd::Constant(total, xi.back());
  if (given > 1) result.head(given) = Eigen::Map<const VectorXd>(xi.data(), given);
  return result;
}

}  // namespace titop::fe
