#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/graph/rotation.hpp>
#include <vector>

/// Stiffness and mass at grids, as Nastran gives them: a reduced model (Craig-Bampton) or all of
/// it.
namespace titop::fe {

/// A row: component 1 to 6 (x, y, z, rx, ry, rz in the grid's own displacement frame) of a grid, or
/// component 0 of a scalar point (a modal coordinate).
struct GridDof {
  int grid = 0, component = 0;
  auto operator<=>(const GridDof&) const = default;
};

struct GridMatrices {
  std::string name;  ///< for messages
  std::vector<GridDof> dofs;
  Eigen::MatrixXd K, M;  ///< n x n, in the data's own units
  double digits = 15;    ///< decimal digits that they carry
};

/// K and M whose rows are six for each of these grids, in this order, and then scalar points: what
/// EXTSEOUT writes to OP4. Scalar points are numbered from 1. Throws size.
GridMatrices grid_matrices(std::string name, const Eigen::MatrixXd& K, const Eigen::MatrixXd& M,
                           const std::vector<int>& grids, double digits);

/// Where a grid is. It becomes a point of the mesh, and an interface if it has a name.
struct Grid {
  int id = 0;
  Vector3d position = Vector3d::Zero();  ///< in the body's frame, in the data's unit of length
  Rotation frame = {};    ///< components in the grid's displacement frame to the body's
  std::string name = {};  ///< empty: its number
};

/// The mesh, with all displacements turned into body axes. Scalar points are generalised
/// coordinates, which rigid motion does not move. Units stay the data's: scale the modal data
/// (`scaled`).
///
/// Throws, all together, unknown_name for a grid that the matrices or the list have alone, and what
/// `check(mesh)` throws. Cost n^2 per turned grid.
Mesh to_mesh(const GridMatrices& matrices, const std::vector<Grid>& grids);

/// Rigid motions (n x 6) by statics, for data without positions: what all rows do when the six of
/// this grid move by one each and nothing else is loaded, R = [1; -K_ff^-1 K_fr]. Their errors are
/// those of K: digits over its condition. Throws bad_modes where the grid lacks a component or K_ff
/// is not definite. Cost n^3 / 3.
Eigen::MatrixXd rigid_motions_by_statics(const GridMatrices& matrices, int grid);

}  // namespace titop::fe
