#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

/// Reader for the matrices that CalculiX writes with `*FREQUENCY, SOLVER=MATRIXSTORAGE`.
///
/// To have a structure with places where other bodies attach: make each place a `*RIGID BODY` with
/// a REF NODE (its three displacements) and a ROT NODE (whose "displacements" 1..3 are the
/// rotations of the body), leave it free (no `*BOUNDARY`), and run the deck. The deck must be in SI
/// units. For `*COUPLING`, beams and shells CalculiX creates nodes whose rows have no position: use
/// rigid bodies and solid elements instead.
namespace titop::fe {

/// The four files of one run.
struct CalculixFiles {
  std::filesystem::path stiffness;  ///< .sti: `row column value`, counted from 1, one triangle
  std::filesystem::path mass;       ///< .mas: likewise
  std::filesystem::path dofs;       ///< .dof: `node.dof`, one line per row of the matrices
  std::filesystem::path deck;       ///< .inp: `*NODE` (positions) and `*RIGID BODY`
};

/// stem + ".sti", ".mas", ".dof", ".inp"; e.g. stem = "data/beam".
CalculixFiles calculix_files(const std::filesystem::path& stem);

/// A reference node that gets a name, e.g. {"P", 900001}.
struct CalculixInterface {
  std::string name;
  int node = 0;
};

/// Data read from a deck.
struct CalculixDeck {
  struct RigidConstraint {
    int ref_node = 0;
    int rot_node = 0;
    int line = 0;
  };
  std::map<int, Vector3d> nodes;  ///< positions [m] by node number
  /// Keywords for which CalculiX makes nodes that the deck does not have: `*COUPLING`, elements
  /// that it expands (beams, shells, trusses, plane ones), with their lines.
  std::vector<std::string> makes_nodes = {};
  std::optional<double> least_E = {};  ///< smallest Young's modulus of its isotropic materials
  std::vector<RigidConstraint> rigid_bodies;
};

/// Node positions and rigid bodies of a deck; all other keywords are ignored. Throws `bad_file`,
/// with file and line of each mistake, for input that would change positions or rigid bodies but is
/// not supported (`*INCLUDE`, parameters of `*NODE` other than NSET, a rigid body without REF NODE
/// or ROT NODE), and for a bad node number, a bad number, a missing coordinate, two positions of
/// one node.
CalculixDeck read_calculix_deck(const std::filesystem::path& path);

/// Legal values that are probably mistakes: `implausible_modulus` of its materials.
std::vector<std::string> implausible(const CalculixDeck& deck);

/// The free mesh: one point per node with degrees of freedom, named by its number; a rigid body is
/// one point, named by its reference node, with displacements and rotations at that node's
/// position. Nodes that depend on a rigid body have no row and are no points. M and K have 14
/// digits.
///
/// Throws `bad_file`, all mistakes of a file together, each with file, line, the text found and the
/// text expected: not a number, not finite, too few or many columns, an index outside the rows of
/// .dof, an entry given twice with different values, a row without diagonal entry (a truncated
/// file, or fewer rows than .dof has), a label twice, a label without a node in the deck, an empty
/// file, a last line without line end. Throws `unknown_name` for an interface that is not a point.
/// Files with CR LF are read. Dense: 16 n^2 bytes for n rows.
Mesh read_calculix(const CalculixFiles& files,
                   const std::vector<CalculixInterface>& interfaces = {});

}  // namespace titop::fe
