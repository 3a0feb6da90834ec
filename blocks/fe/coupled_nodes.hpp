#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/line_shapes.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/node_sets.hpp>
#include <vector>

/// The nodes of one interface, with their rigid motion. For the folder's own files.
namespace titop::fe {

/// Refers to the mesh, which must outlive it.
struct CoupledNodes {
  const Mesh& mesh;
  std::string name;  ///< of the interface
  NodeSet set;
  Vector3d centre = Vector3d::Zero();   ///< of the interface's point
  std::vector<Eigen::Index> rows = {};  ///< of the nodes, ascending
  std::vector<int> moving = {};         ///< directions of the point in which the mesh moves
  Eigen::MatrixXd R = {};               ///< rows x moving
  double length = 0;                    ///< radius of gyration of the nodes [m]; 0: one place
};

CoupledNodes coupled_nodes(const Mesh& mesh, const std::string& name, const NodeSet& nodes,
                           const Vector3d& centre);

/// Throws bad_modes, with the direction, if the rows B u do not determine the rigid motion of the
/// nodes.
void require_determined(const CoupledNodes& nodes, const Eigen::MatrixXd& B);

/// Displacements of the nodes with their weights; of rotations that these do not determine, the
/// nodes' own.
Observation measure_of(const CoupledNodes& nodes);

/// Basis of the motions u of the rows with A u = 0: orthonormal in coordinates of equal size. A:
/// fewer rows than columns, of full rank.
Eigen::MatrixXd null_basis(const CoupledNodes& nodes, const Eigen::MatrixXd& A);

/// The mesh with rows u of the nodes replaced by c, u = T c, which are these degrees of freedom,
/// the last ones of the result.
Mesh replaced(const CoupledNodes& nodes, const Eigen::MatrixXd& T, const std::vector<Dof>& dofs);

}  // namespace titop::fe
