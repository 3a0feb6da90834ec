#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/normal_modes.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Largest displacement and rotation in each mode (2 x N).
MatrixXd sizes(const MatrixXd& shape) {
  MatrixXd size(2, shape.cols());
  size << shape.topRows<3>().cwiseAbs().colwise().maxCoeff(),
      shape.bottomRows<3>().cwiseAbs().colwise().maxCoeff();
  return size;
}

/// From the grid's displacement frame to the basic one.
MatrixXd in_basic(const Grid& grid, MatrixXd values) {
  const Matrix3d T = grid.frame.nominal();
  values.topRows<3>() = (T * values.topRows<3>()).eval();
  values.bottomRows<3>() = (T * values.bottomRows<3>()).eval();
  return values;
}

constexpr double kUnitMass = 1e-5;    ///< of printed sums
constexpr double kSameMotion = 1e-3;  ///< of supports' forces, relative to the rigid mass

/// A body accelerated by P alone has f = -omega^2 L_P' as support forces of each mode, about P: not
/// if the run has other supports, or if L_P is about another grid.
void require_support(const detail::ClampedRun& run, const Grid& P) {
  const Index n = run.modes.omega.size();
  const auto held = run.forces.find(P.id);
  const MatrixXd forces =
      held == run.forces.end() ? MatrixXd::Zero(6, n) : in_basic(P, held->second);
  for (Index k = 0; k < n; ++k)
    for (Index c = 0; c < 6; ++c) {
      const double square = run.modes.omega(k) * run.modes.omega(k);
      const double size = std::sqrt(run.D.diagonal().segment<3>(c < 3 ? 0 : 3).maxCoeff());
      if (std::abs(forces(c, k) + square * run.L(c, k)) <= kSameMotion * square * size) continue;
      throw Error(
          Code::bad_file,
          fmt::format("{}: the support forces of grid {} in mode {} are not those of its "
                      "participation factors (MPFACS)",
                      run.file, P.id, k + 1),
          fmt::format("the run has more supports than grid {}, or MEFFMASS refers to another "
                      "grid: {}",
                      P.id, run.ask));
    }
}

constexpr double kLastDigit = 1e-6;  ///< of sqrt(D_ii D_jj): a unit of the seventh digit

void require_unit_masses(const detail::ClampedRun& run) {
  for (Index k = 0; k < run.modes.mass.size(); ++k)
    if (!(std::abs(run.modes.mass(k) - 1) <= kUnitMass))
      throw Error(Code::bad_file,
                  fmt::format("{}: mode {} has the generalised mass {:.6g}, not 1", run.file, k + 1,
                              run.modes.mass(k)),
                  "normalise the modes to MASS, in EIGRL or EIGR");
}

}  // namespace

std::vector<int> grids_at_rest(const NormalModes& modes) {
  MatrixXd largest = MatrixXd::Zero(2, modes.omega.size());
  for (const auto& [grid, shape] : modes.shapes) largest = largest.cwiseMax(sizes(shape));
  std::vector<int> grids;
  for (const auto& [grid, shape] : modes.shapes)
    if ((sizes(shape).array() <= linalg::kTextDigits * largest.array()).all())
      grids.push_back(grid);
  return grids;
}

namespace detail {

const Grid& find_grid(const std::vector<Grid>& grids, const std::string& file,
                      const std::string& name) {
  for (const Grid& g : grids)
    if (std::to_string(g.id) == name) return g;
  throw Error(Code::unknown_name, fmt::format("{} has no grid {}", file, name),
              "take the number of a GRID");
}

void require_at_rest(const NormalModes& modes, const std::string& file, const Grid& parent) {
  const std::vector<int> rest = grids_at_rest(modes);
  if (std::ranges::find(rest, parent.id) != rest.end()) return;
  throw Error(Code::bad_value, fmt::format("{}: grid {} moves in the modes", file, parent.id),
              fmt::format("SPC1 123456 at it, or take the clamped grid; at rest are {}",
                          fmt::join(rest, ", ")));
}

Matrix6 symmetric_mass(const Matrix6& D, const std::string& file) {
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < i; ++j) {
      const double off = std::abs(D(i, j) - D(j, i));
      if (off <= kLastDigit * std::sqrt(std::abs(D(i, i) * D(j, j)))) continue;
      const auto name = [](Index k) { return component_name(static_cast<int>(k)); };
      throw Error(Code::bad_file,
                  fmt::format("{}: the rigid mass has {:.6e} for {}, {}, and {:.6e} for {}, {}",
                              file, D(i, j), name(i), name(j), D(j, i), name(j), name(i)),
                  "a symmetric matrix: take the file as the program has written it");
    }
  return (D + D.transpose()) / 2;
}

ModalData clamped_modal_data(const ClampedRun& run, const std::string& parent,
                             const std::vector<std::string>& children) {
  const Grid& P = find_grid(run.grids, run.file, parent);
  require_at_rest(run.modes, run.file, P);
  require_unit_masses(run);
  require_support(run, P);
  ModalData data;
  data.omega = run.modes.omega;
  data.xi = VectorXd::Zero(run.modes.omega.size());
  data.L_P = run.L.transpose();
  data.D_P = run.D;
  data.digits = run.digits;
  for (const std::string& child : children) {
    const Grid& C = find_grid(run.grids, run.file, child);
    const auto shape = run.modes.shapes.find(C.id);
    if (shape == run.modes.shapes.end())
      throw Error(Code::unknown_name, fmt::format("{} has no shapes of grid {}", run.file, child),
                  run.ask);
    data.children.push_back({child, C.position - P.position, in_basic(C, shape->second)});
  }
  return data;
}

}  // namespace detail

}  // namespace titop::fe
