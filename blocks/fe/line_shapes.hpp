#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/node_sets.hpp>
#include <vector>

/// Shapes of an edge, and how a motion of its nodes is measured by them. For the folder's own
/// files.
namespace titop::fe {

/// A straight line of nodes along a body axis.
struct EdgeLine {
  int axis = 0;
  double length = 0;  ///< [m]
  Vector3d middle = Vector3d::Zero();
  Eigen::VectorXd at;  ///< of each node, -1 to 1
  NodeSet nodes;       ///< in this order
};

/// Throws bad_value if the nodes are not on one line along x, y or z, to `place_tolerance`, or if
/// another node with degrees of freedom is between them.
EdgeLine line_of(const Mesh& mesh, const NodeSet& nodes);

/// The shapes of m polynomials, for components that all nodes of the line have.
std::vector<LineShape> shapes_of(const Mesh& mesh, const EdgeLine& line,
                                 const std::vector<Eigen::Index>& rows, int m);

/// A shape's displacements of these rows of the line's nodes.
Eigen::VectorXd displacements(const Mesh& mesh, const EdgeLine& line,
                              const std::vector<Eigen::Index>& rows, const LineShape& shape);

/// Displacements and rotations that are measured: B u, with the weights W of their least squares.
struct Observation {
  Eigen::MatrixXd B, W;
};
/// Of the line's displacements and of its rotation about itself, along its length.
Observation measure_of(const Mesh& mesh, const EdgeLine& line,
                       const std::vector<Eigen::Index>& rows);

}  // namespace titop::fe
