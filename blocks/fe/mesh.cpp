#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Largest |S - S'| relative to sqrt(S_ii S_jj), and its place. In a semidefinite matrix no entry
/// exceeds the geometric mean of its two diagonals: a scale that does not mix units.
struct Skewness {
  double size = 0;
  Index row = 0, column = 0;
};

Skewness skewness(const MatrixXd& S) {
  const Eigen::VectorXd root = S.diagonal().cwiseAbs().cwiseSqrt();
  Skewness worst;
  for (Index j = 0; j < S.cols(); ++j)
    for (Index i = j + 1; i < S.rows(); ++i) {
      const double off = std::abs(S(i, j) - S(j, i));
      if (off == 0 || off <= worst.size * root(i) * root(j)) continue;
      const double size = root(i) * root(j);
      worst = {size > 0 ? off / size : std::numeric_limits<double>::infinity(), i, j};
    }
  return worst;
}

void check_matrix(const Mesh& mesh, const MatrixXd& S, char name, std::vector<Mistake>& mistakes) {
  const auto n = static_cast<Index>(mesh.dofs.size());
  if (S.rows() != n || S.cols() != n) {
    mistakes.push_back({Code::size,
                        fmt::format("{} of mesh {} is {} x {}, it has {} degrees of freedom", name,
                                    mesh.name, S.rows(), S.cols(), n),
                        {},
                        "M and K have one row and one column per degree of freedom"});
    return;
  }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i)
      if (!std::isfinite(S(i, j))) {
        mistakes.push_back({Code::not_finite,
                            fmt::format("{}({}, {}) of mesh {} is not finite", name,
                                        dof_name(mesh, i), dof_name(mesh, j), mesh.name),
                            {},
                            "give finite numbers"});
        return;
      }
  const Skewness found = skewness(S);
  const double most = std::max(10 * std::pow(10, -mesh.digits), linalg::kHalfDigits);
  if (found.size <= most) return;
  const Index i = found.row, j = found.column;
  mistakes.push_back(
      {Code::bad_value,
       fmt::format("{} of mesh {} is not symmetric: {} at ({}, {}), {} at ({}, {}), by {:.2g} of "
                   "its diagonal there",
                   name, mesh.name, S(i, j), dof_name(mesh, i), dof_name(mesh, j), S(j, i),
                   dof_name(mesh, j), dof_name(mesh, i), found.size),
       {},
       fmt::format("give both triangles; rounding of a static reduction is up to {:.2g}, data with "
                   "fewer digits have a smaller Mesh::digits",
                   most)});
}

/// Returns false if an index is out of range, so that nothing may be named.
bool check_indices(const Mesh& mesh, std::vector<Mistake>& mistakes) {
  const std::size_t before = mistakes.size();
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const Dof& dof = mesh.dofs[i];
    if (dof.point < mesh.points.size() && dof.component >= 0 && dof.component <= kTwist) continue;
    mistakes.push_back({Code::bad_value,
                        fmt::format("row {} of mesh {} is component {} of point {}, there are {} "
                                    "points of 6 components",
                                    i, mesh.name, dof.component, dof.point, mesh.points.size()),
                        {},
                        "points count from 0, components are 0 to 5, kGeneralised or kTwist"});
  }
  for (const MeshInterface& interface : mesh.interfaces)
    if (interface.point >= mesh.points.size())
      mistakes.push_back(
          {Code::bad_value,
           fmt::format("interface {} of mesh {} is point {}, there are {}", interface.name,
                       mesh.name, interface.point, mesh.points.size()),
           {},
           "points count from 0"});
  return mistakes.size() == before;
}

void check_names(const Mesh& mesh, std::vector<Mistake>& mistakes) {
  std::set<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!names.insert(name).second)
      mistakes.push_back({Code::duplicate_name,
                          fmt::format("mesh {} has two points or interfaces {}", mesh.name, name),
                          {},
                          "give each a name of its own"});
  };
  for (const MeshPoint& point : mesh.points) add(point.name);
  for (const MeshInterface& interface : mesh.interfaces) add(interface.name);
  std::set<std::pair<std::size_t, int>> rows;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (!rows.insert({mesh.dofs[i].point, mesh.dofs[i].component}).second)
      mistakes.push_back(
          {Code::duplicate_name,
           fmt::format("mesh {} has two rows {}", mesh.name, dof_name(mesh, static_cast<Index>(i))),
           {},
           "give each degree of freedom one row"});
}

}  // namespace

void check(const Mesh& mesh) {
  std::vector<Mistake> mistakes;
  if (check_indices(mesh, mistakes)) {
    check_names(mesh, mistakes);
    check_matrix(mesh, mesh.M, 'M', mistakes);
    check_matrix(mesh, mesh.K, 'K', mistakes);
    for (const MeshPoint& point : mesh.points)
      if (!point.position.allFinite())
        mistakes.push_back({Code::not_finite,
                            fmt::format("the position of point {} of mesh {} is not finite",
                                        point.name, mesh.name),
                            {},
                            "give finite coordinates [m]"});
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

double asymmetry(const Mesh& mesh) {
  return std::max(skewness(mesh.K).size, skewness(mesh.M).size);
}

Mesh symmetrised(Mesh mesh) {
  const double found = asymmetry(mesh);
  if (found == 0) return mesh;
  for (MatrixXd* S : {&mesh.K, &mesh.M}) *S = ((*S + S->transpose()) / 2).eval();
  mesh.digits = std::min(mesh.digits, 1 - std::log10(found));
  return mesh;
}

std::string dof_name(const Mesh& mesh, Index row) {
  const Dof& dof = mesh.dofs.at(static_cast<std::size_t>(row));
  std::string name = mesh.points.at(dof.point).name;
  for (const MeshInterface& interface : mesh.interfaces)
    if (interface.point == dof.point) name = interface.name;
  if (dof.component == kGeneralised) return name;
  if (dof.component == kTwist) return name + ".wxy";
  return fmt::format("{}.{}", name, component_name(dof.component));
}

bool is_plate_node(const Mesh& mesh, std::size_t point) {
  return std::ranges::any_of(
      mesh.dofs, [&](const Dof& dof) { return dof.point == point && dof.component == kTwist; });
}

std::size_t find_point(const Mesh& mesh, const std::string& name) {
  for (const MeshInterface& interface : mesh.interfaces)
    if (interface.name == name) return interface.point;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (mesh.points[i].name == name) return i;
  std::string known;
  for (const MeshInterface& interface : mesh.interfaces)
    known += (known.empty() ? "" : ", ") + interface.name;
  if (!known.empty()) known = "its interfaces are " + known + "; ";
  std::vector<std::string> points;
  for (const MeshPoint& point : mesh.points) points.push_back(point.name);
  throw Error(Code::unknown_name, fmt::format("mesh {} has no point {}", mesh.name, name),
              known + "its points are " + titop::detail::some_names(points));
}

MatrixXd rigid_motions(const Mesh& mesh, const Vector3d& P) {
  MatrixXd R = MatrixXd::Zero(static_cast<Index>(mesh.dofs.size()), 6);
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const Dof& dof = mesh.dofs[i];
    if (dof.component < kGeneralised)
      R.row(static_cast<Index>(i)) = tau(P - mesh.points.at(dof.point).position).row(dof.component);
  }
  return R;
}

std::array<bool, 6> still_directions(const Mesh& mesh, const Vector3d& P) {
  const MatrixXd R = rigid_motions(mesh, P);
  std::array<bool, 6> still{};
  if (R.rows() == 0) return still;
  const double length = R.cwiseAbs().maxCoeff();
  for (int c = 0; c < 6; ++c)
    still.at(static_cast<std::size_t>(c)) =
        R.col(c).cwiseAbs().maxCoeff() <= linalg::kAxisRounding * length;
  return still;
}

std::array<Index, 6> interface_rows(const Mesh& mesh, const std::string& name,
                                    const std::array<bool, 6>& rigid) {
  const std::size_t point = find_point(mesh, name);
  std::array<Index, 6> rows;
  rows.fill(-1);
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i].point == point && mesh.dofs[i].component < kGeneralised)
      rows.at(static_cast<std::size_t>(mesh.dofs[i].component)) = static_cast<Index>(i);
  const std::array<bool, 6> still = still_directions(mesh, mesh.points[point].position);
  std::string missing;
  bool planar = true;
  for (std::size_t c = 0; c < 6; ++c) {
    if (rows.at(c) >= 0 || rigid.at(c)) continue;
    missing += std::string(missing.empty() ? "" : ", ") + component_name(int(c));
    planar = planar && still.at(c);
  }
  if (missing.empty()) return rows;
  std::string hint = planar ? "the whole mesh leaves these directions out: give the rigid mass "
                              "matrix about the parent (ModeOptions::rigid; titop import --mass), "
                              "and the body is rigid "
                              "in them"
                            : "tie it to a node with rotations (a rigid body element) in the "
                              "finite-element program";
  if (!planar && is_plate_node(mesh, point))
    hint =
        "a node of a plate with a membrane has no rotation about z: take several, by fe::rigid or "
        "fe::average over the real footprint";
  for (const MeshInterface& other : mesh.interfaces)
    if (std::ranges::find(other.nodes, point) != other.nodes.end())
      hint = fmt::format(
          "its rows belong to the interface {}: name that, or leave this node out "
          "of it",
          other.name);
  throw Error(Code::bad_modes,
              fmt::format("point {} of mesh {} cannot be an interface: it has no degree of "
                          "freedom {}",
                          name, mesh.name, missing),
              hint);
}

}  // namespace titop::fe
