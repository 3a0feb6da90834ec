#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <titop/blocks/fe/grids.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

std::set<int> grids_of(const GridMatrices& m) {
  std::set<int> result;
  for (const GridDof& dof : m.dofs)
    if (dof.component > 0) result.insert(dof.grid);
  return result;
}

void require_same_grids(const GridMatrices& m, const std::vector<Grid>& grids) {
  std::vector<Mistake> mistakes;
  std::set<int> missing = grids_of(m);
  const std::set<int> there = missing;
  for (const Grid& g : grids) {
    missing.erase(g.id);
    if (!there.contains(g.id))
      mistakes.push_back({Code::unknown_name,
                          fmt::format("the matrices of {} have no grid {}", m.name, g.id),
                          {},
                          "take it out of the list"});
  }
  for (const int id : missing)
    mistakes.push_back({Code::unknown_name,
                        fmt::format("grid {} of {} has no position", id, m.name),
                        {},
                        fmt::format("add Grid{{.id = {}, .position = ...}} to the list", id)});
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

/// G with u_data = G u_body: identity except for the grids that have a frame of their own.
void turn(const GridMatrices& m, const Grid& grid, Mesh& mesh) {
  if (grid.frame.is_identity()) return;
  const Matrix3d T = grid.frame.nominal();
  for (const int first : {1, 4}) {  // translations, rotations
    std::vector<Index> rows;
    for (int c = first; c < first + 3; ++c) {
      const auto at = std::find(m.dofs.begin(), m.dofs.end(), GridDof{grid.id, c});
      if (at != m.dofs.end()) rows.push_back(at - m.dofs.begin());
    }
    if (rows.empty()) continue;
    if (rows.size() != 3)
      throw Error(Code::bad_modes,
                  fmt::format("grid {} of {} has a frame of its own, and {} of three {}", grid.id,
                              m.name, rows.size(), first == 1 ? "displacements" : "rotations"),
                  "keep all three of them in the finite-element program, or none");
    for (MatrixXd* S : {&mesh.K, &mesh.M}) {
      (*S)(rows, Eigen::all) = (T * (*S)(rows, Eigen::all)).eval();
      (*S)(Eigen::all, rows) = ((*S)(Eigen::all, rows) * T.transpose()).eval();
    }
  }
}

}  // namespace

void check(const GridMatrices& m) {
  const auto n = std::ssize(m.dofs);
  if (m.K.rows() != n || m.K.cols() != n || m.M.rows() != n || m.M.cols() != n)
    throw Error(Code::size,
                fmt::format("{}: K is {} x {}, M is {} x {}, for {} degrees of freedom", m.name,
                            m.K.rows(), m.K.cols(), m.M.rows(), m.M.cols(), n),
                "one row and column of both per entry of GridMatrices::dofs");
}

GridMatrices grid_matrices(std::string name, const MatrixXd& K, const MatrixXd& M,
                           const std::vector<int>& grids, double digits) {
  const auto six = 6 * static_cast<Index>(grids.size());
  if (K.rows() != K.cols() || M.rows() != K.rows() || M.cols() != K.rows() || K.rows() < six)
    throw Error(Code::size,
                fmt::format("{}: K is {} x {}, M is {} x {}, for {} grids", name, K.rows(),
                            K.cols(), M.rows(), M.cols(), grids.size()),
                "both must be square and alike, with six rows per grid");
  GridMatrices result{std::move(name), {}, K, M, digits};
  for (const int id : grids)
    for (int c = 1; c <= 6; ++c) result.dofs.push_back({id, c});
  for (int i = 1; static_cast<Index>(result.dofs.size()) < K.rows(); ++i)
    result.dofs.push_back({i, 0});
  return result;
}

Mesh to_mesh(const GridMatrices& m, const std::vector<Grid>& grids) {
  check(m);
  require_same_grids(m, grids);
  Mesh mesh;
  mesh.name = m.name;
  mesh.K = m.K;
  mesh.M = m.M;
  mesh.digits = m.digits;
  std::map<int, std::size_t> point;
  for (const Grid& g : grids) {
    point[g.id] = mesh.points.size();
    if (!g.name.empty()) mesh.interfaces.push_back({g.name, mesh.points.size()});
    mesh.points.push_back({std::to_string(g.id), g.position});
    mesh.position_noise = std::max(mesh.position_noise, g.noise);
  }
  for (const GridDof& dof : m.dofs) {
    if (dof.component > 0) {
      mesh.dofs.push_back({point.at(dof.grid), dof.component - 1});
    } else {
      mesh.dofs.push_back({mesh.points.size(), kGeneralised});
      mesh.points.push_back({fmt::format("scalar {}", dof.grid), Vector3d::Zero()});
    }
  }
  for (const Grid& g : grids) turn(m, g, mesh);
  check(mesh);
  return symmetrised(std::move(mesh));
}

std::vector<GridDof> empty_rows(const GridMatrices& m) {
  check(m);
  std::vector<GridDof> result;
  for (Index i = 0; i < m.K.rows(); ++i)
    if (m.K.row(i).isZero(0) && m.M.row(i).isZero(0) && m.K.col(i).isZero(0) &&
        m.M.col(i).isZero(0))
      result.push_back(m.dofs[static_cast<std::size_t>(i)]);
  return result;
}

GridMatrices without(GridMatrices m, const std::vector<GridDof>& rows) {
  check(m);
  const std::set<GridDof> there(m.dofs.begin(), m.dofs.end());
  for (const GridDof& dof : rows)
    if (!there.contains(dof))
      throw Error(Code::unknown_name,
                  fmt::format("the matrices of {} have no component {} of grid {}", m.name,
                              dof.component, dof.grid),
                  "take it out of the list");
  std::vector<Index> kept;
  std::vector<GridDof> dofs;
  const std::set<GridDof> dropped(rows.begin(), rows.end());
  for (std::size_t i = 0; i < m.dofs.size(); ++i) {
    if (dropped.contains(m.dofs[i])) continue;
    kept.push_back(static_cast<Index>(i));
    dofs.push_back(m.dofs[i]);
  }
  m.K = m.K(kept, kept).eval();
  m.M = m.M(kept, kept).eval();
  m.dofs = std::move(dofs);
  return m;
}

}  // namespace titop::fe
