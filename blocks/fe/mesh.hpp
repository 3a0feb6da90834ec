#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Finite-element models, free in space, and their conversion to `ModalData`.
namespace titop::fe {

/// A node: a place that degrees of freedom belong to.
struct MeshPoint {
  std::string name;
  Vector3d position = Vector3d::Zero();  ///< in the body's frame [m]
};

constexpr int kGeneralised = 6;
constexpr int kTwist = 7;

/// One row of M and K: a displacement of a point along a body axis (component 0, 1, 2: x, y, z)
/// or its rotation about one (3, 4, 5: rx, ry, rz). Or a generalised coordinate, such as that of a
/// fixed-interface mode, independent of rigid motion (kGeneralised; a separate point names it). Or
/// the second derivative of a plate's deflection by x and y [1/m], which no rigid motion changes
/// (kTwist, of a point with z, rx, ry).
struct Dof {
  std::size_t point = 0;  ///< index into Mesh::points
  int component = 0;      ///< 0..5, kGeneralised or kTwist
};

/// A point under a second name, where other bodies may be attached. It must have all six dofs, but
/// for directions in which the whole mesh is rigid (`ModeOptions::rigid`).
struct MeshInterface {
  std::string name;
  std::size_t point = 0;                ///< index into Mesh::points
  std::vector<std::size_t> nodes = {};  ///< whose rows it replaces (`with_interface`)
};

/// Points along an edge, in order.
struct MeshEdge {
  std::string name;
  std::vector<std::size_t> points;  ///< indices into Mesh::points
};

/// An interface along a straight edge (`shapes`, `moments`): the coordinates of its shapes beside
/// the six degrees of freedom of the point of its name.
struct MeshLine {
  std::string name;                 ///< of the interface
  int axis = 0;                     ///< body axis along which it runs
  double length = 0;                ///< [m]
  std::vector<LineShape> shapes;    ///< one coordinate each
  std::vector<std::size_t> points;  ///< those that name the coordinates, kGeneralised
};

/// A free-free structure: no degree of freedom is fixed. SI units, body axes.
struct Mesh {
  std::string name;               ///< for messages
  std::vector<MeshPoint> points;  ///< names differ
  std::vector<Dof> dofs;          ///< n, one per row of M and K
  std::vector<MeshInterface>
      interfaces;                    ///< names differ from each other and from the points' names
  Eigen::MatrixXd M;                 ///< n x n, symmetric, semidefinite [kg, kg m, kg m^2]
  Eigen::MatrixXd K;                 ///< n x n, symmetric, semidefinite [N/m, N, N m]
  double digits = 15;                ///< decimal digits that M and K carry
  double position_noise = 0;         ///< relative error of the positions (`grids_by_statics`)
  std::vector<MeshEdge> edges = {};  ///< named edges, of a plate "x0", "x1", "y0", "y1"
  std::vector<MeshLine> lines = {};  ///< interfaces that are edges (`with_interface`)
  /// Of meshes that move in some directions only: mass matrix of the whole body about the origin of
  /// its frame, which is rigid in the others. `ModeOptions::rigid` replaces it.
  std::optional<Matrix6> rigid = {};
  std::vector<std::string> warnings = {};  ///< `implausible` of the data; into ModalData::warnings
};

/// Throws, all together: inconsistent sizes of M and K (`size`), entries that are not finite
/// (`not_finite`), asymmetry beyond the data's digits and half the digits of double, indices out of
/// range (`bad_value`), names or degrees of freedom given twice (`duplicate_name`). Cost n^2.
void check(const Mesh& mesh);

/// Largest |S - S'| of K and M relative to sqrt(S_ii S_jj). Matrices that a program has reduced
/// statically, K_aa - K_ao K_oo^-1 K_oa, have up to n u sqrt(condition of K) of it [H 13.3],
/// and no Cholesky factorisation ends with a condition above 1 / u. Cost n^2.
double asymmetry(const Mesh& mesh);

/// The mesh with (S + S') / 2 for K and M, and `digits` lowered to those that its asymmetry
/// leaves: 1 - log10(asymmetry). The mesh itself if it is symmetric. All functions that make
/// `ModalData` of a mesh begin with it. Cost n^2.
Mesh symmetrised(Mesh mesh);

/// "17.x", "C.ry", "3,4.wxy" (an interface's name before its point's). Row counts from 0.
std::string dof_name(const Mesh& mesh, Eigen::Index row);

/// True for a node of a plate, which has a row kTwist.
bool is_plate_node(const Mesh& mesh, std::size_t point);

/// Index into Mesh::points of the interface or point of this name; throws `unknown_name` with the
/// list of interfaces.
std::size_t find_point(const Mesh& mesh, const std::string& name);

/// Directions x, y, z, rx, ry, rz in which no row moves with a rigid motion of P: those that a
/// planar model, or one of a torsion bar, leaves out. [m]
std::array<bool, 6> still_directions(const Mesh& mesh, const Vector3d& P);

/// The rows of x, y, z, rx, ry, rz of the interface or point of this name, -1 for those that it
/// does not have. Throws `unknown_name`, or `bad_modes` if one of the six is missing, but for
/// `rigid` ones.
std::array<Eigen::Index, 6> interface_rows(const Mesh& mesh, const std::string& name,
                                           const std::array<bool, 6>& rigid = {});

/// R (n x 6): displacement of every degree of freedom per unit rigid motion in each component of P
/// (translations, rotations). Rows of tau_{point,P}; P in the body's frame [m].
Eigen::MatrixXd rigid_motions(const Mesh& mesh, const Vector3d& P);

/// Damping matrix mass M + stiffness K of a mesh [Craig and Kurdila 2006, 10.3]. It acts on motions
/// relative to the parent, whose rigid motion is undamped.
struct Rayleigh {
  double mass = 0;       ///< alpha [1/s]
  double stiffness = 0;  ///< beta [s]
};

/// Selection of the modes of a mesh.
struct ModeOptions {
  /// Number of lowest clamped modes; all of them if absent.
  std::optional<int> kept = {};
  /// Interfaces that get residual vectors, which make their static response exact: for a child the
  /// six responses to a unit wrench there, for the parent those to a unit acceleration, and for
  /// either the response to a unit force of each shape of its line. At most six modes more for
  /// each, and one per shape; name every child with a heavy or stiff load.
  std::vector<std::string> residual = {};
  /// Damping ratios: none (undamped), one (for all), one per kept mode (a residual vector takes
  /// that of the highest kept mode) or one per mode with the residual ones.
  std::vector<double> xi = {};
  /// In place of xi: each clamped mode and residual vector, at its omega, gets the damping ratio
  /// (mass / omega + stiffness omega) / 2.
  std::optional<Rayleigh> rayleigh = {};
  /// Of models that move in some directions only, such as a beam with z, rx, ry: the mass matrix
  /// about P of the whole body, `rigid_mass(m, inertia, from the centre of mass to P)`. D_P has
  /// its rows and columns in the still directions, in which the body is rigid; interfaces need no
  /// degrees of freedom there. In the other directions it must agree with R'MR to 1e-3 of its
  /// diagonal. Without it, and without Mesh::rigid, such models are refused.
  std::optional<Matrix6> rigid = {};
};

/// Modes of the mesh clamped at `parent`, in the form of [Alazard 2015] eqs (9) to (14). With f all
/// rows but the parent's and R = rigid_motions(mesh, P):
///
///     D_P = R'MR    M_rf = R'M(:,f)    Phi'M_ff Phi = I, Phi'K_ff Phi = diag(omega^2)
///     L_P = Phi'M_rf'    Phi_C = rows of Phi at C
///
/// omega ascends. Residual vectors ([Craig 2006] ch. 17; usual in FE programs): X = K_ff^-1 B with
/// B the unit wrenches at C (for the parent: M_rf'), made M-orthogonal to the kept modes, then
/// turned into modes by the small eigenproblem (X'KX, X'MX). They are thus M- and K-orthogonal to
/// all other modes and (14) applies unchanged. Directions in the span of the kept modes are
/// dropped.
///
/// Massless degrees of freedom (M_ff singular) have infinite modes. If all modes are kept, these
/// are condensed exactly, which requires that no child moves in them; if a number of modes is
/// given, they are truncated like other high modes, and residual vectors contain their static part.
///
/// Lines of the parent and the children become ModalData::lines; those of other interfaces move
/// freely. A parent or child at a single node of a plate is noted in ModalData::warnings, behind
/// Mesh::warnings.
///
/// Throws the errors of `check` and `interface_rows`; `duplicate_name` for a child named twice;
/// `bad_value` for `rigid` if the mesh moves in all six directions, or has another mass in those in
/// which it moves;
/// `bad_modes` if K resists rigid motion by more than 1e-6 of its terms (or 100 units of its last
/// digit, or ten times the positions' error; `rigid_stiffness`): data of a supported structure, or
/// positions in another unit; if K clamped at the parent is not positive definite (a mechanism:
/// names a degree of freedom), if M is not positive semidefinite, or if all modes are kept and a
/// child has a massless degree of freedom; `bad_value` for more modes than there are, and for
/// damping that is negative, not finite or given twice; `size` for a wrong number of damping
/// ratios. Cost about 20 n^3.
ModalData modal_data(const Mesh& mesh, const std::string& parent,
                     const std::vector<std::string>& children, const ModeOptions& options = {});

}  // namespace titop::fe
