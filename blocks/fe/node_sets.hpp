#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

/// Nodes of a mesh that are chosen together, for an interface of many nodes.
namespace titop::fe {

/// Nodes with their weights.
struct NodeSet {
  std::string name;                 ///< for messages: "edge x1"
  std::vector<std::size_t> points;  ///< indices into Mesh::points
  Eigen::VectorXd weights;          ///< one per node, > 0
};

/// Distance below which two places are one [m]: 1e-5 of the largest distance in the mesh, of
/// coordinates with five or six digits; ten times Mesh::position_noise of it if that is more.
double place_tolerance(const Mesh& mesh);

/// The points or interfaces of these names, with equal weights. Throws unknown_name.
NodeSet nodes(const Mesh& mesh, const std::vector<std::string>& names);

/// All points with degrees of freedom in this box, its faces included to `place_tolerance`, with
/// equal weights. low, high: corners in the body's frame [m]. Throws bad_value if there are none.
NodeSet box(const Mesh& mesh, const Vector3d& low, const Vector3d& high);

/// The named edge. Weights are half of the lengths to the neighbours: the trapezoidal rule. Throws
/// unknown_name with the edges that the mesh has.
NodeSet edge(const Mesh& mesh, const std::string& name);

/// The nodes of the named edge between these fractions of its length, from 0 to 1, at which it must
/// have nodes. Throws unknown_name; bad_value unless 0 <= from < to <= 1, and if an end is no node,
/// with the fractions of the nodes beside.
NodeSet segment(const Mesh& mesh, const std::string& edge, double from, double to);

/// All points with degrees of freedom on the straight line from A to B [m], to `place_tolerance`,
/// in this order, with weights as of an edge. Throws bad_value if there are none.
NodeSet segment(const Mesh& mesh, const Vector3d& A, const Vector3d& B);

}  // namespace titop::fe
