#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/fe/clamped.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double kSameMass = 1e-3;  ///< of three printed digits

/// The directions in which the mesh is rigid, if that is wanted.
std::array<bool, 6> rigid_directions(const Mesh& mesh, const Vector3d& P,
                                     const ModeOptions& options) {
  if (!options.rigid && !mesh.rigid) return {};
  const std::array<bool, 6> still = still_directions(mesh, P);
  if (options.rigid && std::ranges::find(still, true) == still.end())
    throw Error(Code::bad_value,
                fmt::format("mesh {} moves in all six directions, and ModeOptions::rigid is given",
                            mesh.name),
                "leave it out: the mass comes from M");
  return still;
}

/// The rigid mass that is given, about P.
std::optional<Matrix6> given_mass(const Mesh& mesh, const Vector3d& P, const ModeOptions& options) {
  if (options.rigid || !mesh.rigid) return options.rigid;
  const Matrix6 at_origin = tau(P);
  return Matrix6(at_origin.transpose() * *mesh.rigid * at_origin);
}

/// Throws unless the rigid mass that is given is that of M in the directions in which M moves.
void require_same_mass(const Mesh& mesh, const Clamped& c, const Matrix6& given) {
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j <= i; ++j) {
      if (c.rigid.at(static_cast<std::size_t>(i)) || c.rigid.at(static_cast<std::size_t>(j)))
        continue;
      const double size = std::sqrt(std::abs(c.D_P(i, i) * c.D_P(j, j)));
      if (std::abs(c.D_P(i, j) - given(i, j)) <= kSameMass * size) continue;
      const auto name = [](Index k) { return component_name(static_cast<int>(k)); };
      throw Error(
          Code::bad_value,
          fmt::format("the rigid mass that is given (ModeOptions::rigid, Mesh::rigid, titop import "
                      "--mass) has {:.6g} "
                      "for {}, {} about the parent, where mesh {} has {:.6g}",
                      given(i, j), name(i), name(j), mesh.name, c.D_P(i, j)),
          "give mass, centre of mass and inertia of the whole body, in the units of the mesh, as "
          "its M has them");
    }
}

/// Names of all rows without stiffness and mass.
std::vector<std::string> names_of_empty_rows(const Mesh& mesh) {
  std::vector<std::string> names;
  for (Index i = 0; i < mesh.K.rows(); ++i)
    if (mesh.K.row(i).isZero(0) && mesh.M.row(i).isZero(0)) names.push_back(dof_name(mesh, i));
  return names;
}

}  // namespace

Clamped clamp(const Mesh& mesh, const std::string& parent, const ModeOptions& options) {
  const Vector3d P = mesh.points[find_point(mesh, parent)].position;
  Clamped c{mesh, {}, {}, {}, {}, {}, rigid_directions(mesh, P, options)};
  const auto rows = interface_rows(mesh, parent, c.rigid);
  for (Index i = 0; i < mesh.M.rows(); ++i)
    if (std::find(rows.begin(), rows.end(), i) == rows.end()) c.f.push_back(i);
  const MatrixXd R = rigid_motions(mesh, P);
  const MatrixXd MR = mesh.M * R;
  const Matrix6 D_P = R.transpose() * MR;
  c.D_P = (D_P + D_P.transpose()) / 2;
  const std::optional<Matrix6> given = given_mass(mesh, P, options);
  if (given) require_same_mass(mesh, c, *given);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if (c.rigid.at(static_cast<std::size_t>(i)) || c.rigid.at(static_cast<std::size_t>(j)))
        c.D_P(i, j) = (*given)(i, j);
  c.M_rf = MR(c.f, Eigen::all).transpose();
  c.M = mesh.M(c.f, c.f);
  c.K = mesh.K(c.f, c.f);
  return c;
}

std::string name_of(const Clamped& c, Index row) {
  return dof_name(c.mesh, c.f[static_cast<std::size_t>(row)]);
}

void refuse_mechanism(const Clamped& c, Index row) {
  if (const auto empty = names_of_empty_rows(c.mesh); !empty.empty())
    throw Error(Code::bad_modes,
                fmt::format("{} rows of mesh {} have neither stiffness nor mass: {}", empty.size(),
                            c.mesh.name, titop::detail::some_names(empty)),
                "rotations of grids on solids and scalar points that no mode took: drop them from "
                "the matrices, m = without(m, empty_rows(m)), before to_mesh");
  throw Error(Code::bad_modes,
              fmt::format("mesh {} clamped at its parent moves without stiffness at {}",
                          c.mesh.name, name_of(c, row)),
              "a part is loose, or K was assembled with supports missing: modes of a mechanism "
              "have no natural frequency");
}

std::vector<Index> loaded_rows(const Clamped& c, const std::vector<std::string>& children) {
  std::vector<Index> loaded;
  for (const std::string& child : children)
    for (const Index row : interface_rows(c.mesh, child, c.rigid)) {
      const auto at = std::find(c.f.begin(), c.f.end(), row);
      if (at != c.f.end()) loaded.push_back(at - c.f.begin());
    }
  return loaded;
}

}  // namespace titop::fe
