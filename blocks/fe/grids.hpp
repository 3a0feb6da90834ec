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

/// Stiffness and mass with the grid and component of each row; free in space.
struct GridMatrices {
  std::string name;  ///< for messages
  std::vector<GridDof> dofs;
  Eigen::MatrixXd K, M;  ///< n x n, in the data's own units
  double digits = 15;    ///< decimal digits that they carry
};

/// Throws size unless K and M have a row and a column per degree of freedom.
void check(const GridMatrices& matrices);

/// K and M with six rows for each of these grids, in this order, then scalar points: the row order
/// that EXTSEOUT writes to OP4. Scalar points are numbered from 1. Throws size.
GridMatrices grid_matrices(std::string name, const Eigen::MatrixXd& K, const Eigen::MatrixXd& M,
                           const std::vector<int>& grids, double digits);

/// Rows that are 0 in both K and M, such as rotations of grids on solids, and scalar points without
/// a mode. A mesh with them has no modes: drop them, `m = without(m, empty_rows(m))`.
std::vector<GridDof> empty_rows(const GridMatrices& matrices);

/// The matrices without these rows and columns. Throws unknown_name for a row that does not exist.
GridMatrices without(GridMatrices matrices, const std::vector<GridDof>& rows);

/// Position of a grid. It becomes a point of the mesh, and an interface if it has a name.
struct Grid {
  int id = 0;
  Vector3d position = Vector3d::Zero();  ///< in the body's frame, in the data's unit of length
  Rotation frame = {};    ///< components in the grid's displacement frame to the body's
  std::string name = {};  ///< empty: its number
  double noise = 0;       ///< relative error of position and frame
};

/// The mesh, with all displacements rotated into body axes. Scalar points are generalised
/// coordinates, independent of rigid motion. Units are those of the data: scale the modal data
/// (`scaled`). K and M are `symmetrised`: `digits` may be fewer than those of the matrices.
///
/// Throws, all together, unknown_name for a grid that only the matrices or only the list contains,
/// and the errors of `check(mesh)`. Cost n^2 per rotated grid.
Mesh to_mesh(const GridMatrices& matrices, const std::vector<Grid>& grids);

/// Rigid motions (n x 6) by statics, for data without positions: displacements of all rows for unit
/// displacements of this grid's six components without other loads, R = [1; -K_ff^-1 K_fr]; columns
/// of components that the grid does not have (planar models) are 0. Relative error: that of K's
/// digits times the condition number of K_ff. Throws unknown_name for a grid that does not exist,
/// bad_modes if K_ff is not positive definite. Cost n^3 / 3.
Eigen::MatrixXd rigid_motions_by_statics(const GridMatrices& matrices, int grid);

/// Positions and frames of all grids by these rigid motions, for data without positions: this grid
/// is the origin, its frame the body's. A grid with three rotations has the frame in which R turns
/// it, others have that of this grid; coordinates on which no row depends (planar models) are 0.
/// Positions are as exact as R: `noise` is by how much R differs from the motion of a rigid body,
/// lengths relative to the largest distance of a grid.
///
/// Throws the errors of `rigid_motions_by_statics`; bad_modes if K resists rigid motion by more
/// than 1e-6 of its terms or 100 units of its last digit, and for a grid that does not move as a
/// rigid body, by more than the errors of K explain (docs/numerics.md), or by more than 1e-3. Cost
/// 3 n^3.
std::vector<Grid> grids_by_statics(const GridMatrices& matrices, int grid);

}  // namespace titop::fe
