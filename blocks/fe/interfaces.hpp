#pragma once

#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/node_sets.hpp>
#include <vector>

/// Interfaces of many nodes: a point of six degrees of freedom, and shapes of an edge, for the
/// motion of a set of nodes.
///
///     fe::Mesh mesh = plate_mesh(panel);
///     mesh = fe::with_interface(mesh, "yoke", fe::average(fe::segment(mesh, "x0", 0.25, 0.75)));
///     mesh = fe::with_interface(mesh, "next", fe::shapes(fe::edge(mesh, "x1"), fe::legendre(3)));
///     FlexibleBody panel{fe::modal_data(mesh, "yoke", {"next"}, {.kept = 10})};
///
/// Nodes u, their rigid motion R about the interface's point, weights W:
///
///     rigid:    u = R x                       constrains the nodes: frequencies rise (RBE2)
///     average:  x = (R'WR)^-1 R'W u           adds no stiffness: frequencies fall (RBE3)
///     shapes:   u = R x + S alpha             constrains the nodes to these shapes
///     moments:  [x; alpha]: the same of u as of its best fit [R S], adds no stiffness
///
/// Rigid or restricted interfaces are an upper bound, averages and moments a lower one, of every
/// frequency of the scene with the fine mesh between both, and of every stiffness [Courant's
/// theorem: constraints raise, releases lower].
namespace titop::fe {

/// m Legendre polynomials along an edge, of degrees 0 to m - 1, for every displacement of its
/// nodes and for their rotation about it, without the motions of the point's six degrees of
/// freedom: degree 0, and of displacements across the edge degree 1.
struct Legendre {
  int count = 0;
};
Legendre legendre(int m);

/// How an interface follows its nodes.
struct Coupling {
  enum class Kind { rigid, average, shapes, moments };
  Kind kind = Kind::rigid;
  NodeSet nodes;
  int count = 0;  ///< m of shapes and moments
};

/// All rows of the nodes move as one rigid body; a plate's twist is 0, if there are several.
Coupling rigid(NodeSet nodes);

/// Weighted least squares of the nodes' displacements. Rotations about axes about which these
/// determine none (that of the nodes' line; all of a single node) are those of the nodes, averaged
/// with the same weights. A force on the point acts on the nodes as W R (R'WR)^-1 F. Weights: those
/// of the set, or others, one per node.
Coupling average(NodeSet nodes);
Coupling average(NodeSet nodes, const std::vector<double>& weights);

/// The nodes of a straight edge along a body axis move by these shapes alone, as thin beams do:
/// the rotation across the edge is the slope of the displacement.
Coupling shapes(NodeSet edge, Legendre polynomials);

/// Coefficients of the edge's motion by these shapes, by least squares of its displacements and its
/// rotation about the edge along its length: of a plate by the integrals of its Hermite functions,
/// else, and of a membrane in its plane, by the trapezoidal rule. The rest of its motion is free.
Coupling moments(NodeSet edge, Legendre polynomials);

/// The mesh with this interface, for one coordinate each in place of the nodes' rows: six of a new
/// point at the nodes' weighted centre (the middle of an edge), without directions in which the
/// whole mesh is still; those of the shapes; and, if the nodes stay free, those of the rest of
/// their motion, kGeneralised. The nodes keep their names and places, without rows. A rigid or
/// average interface of one node is a second name for it.
///
/// Throws bad_modes: a node without rows (it is part of another interface); nodes on one line that
/// determine no rotation about it, with the axis. bad_value: more polynomials than nodes at
/// different places, fewer than 2; nodes of shapes that are not on one line along a body axis, or
/// leave out another one between them; a node named twice; weights that are not positive;
/// duplicate_name: a name that the mesh has; size: a wrong number of weights. Cost n^2 r for n rows
/// of the mesh, r of the nodes.
Mesh with_interface(const Mesh& mesh, const std::string& name, const Coupling& coupling);

}  // namespace titop::fe
