#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/graph/data_digits.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Quality of modal data, to be checked before a model is made from them. No function here throws
/// or changes data; all measures but plain masses are independent of units.
namespace titop {

/// A 6 x 6 mass matrix read as that of a rigid body.
struct MassProperties {
  Vector3d mass = Vector3d::Zero();     ///< along x, y, z: three equal values [kg]
  Vector3d centre = Vector3d::Zero();   ///< centre of mass from P [m]
  Matrix3d inertia = Matrix3d::Zero();  ///< about the centre of mass [kg m^2]
  double misfit = 0;  ///< largest |D_P - rigid_mass(...)| relative to sqrt(D_ii D_jj): 0 for a
                      ///< rigid body; mass neglected by FE programs appears here
};
MassProperties mass_properties(const Matrix6& D_P);

/// Sign of a residual mass, within the digits of the data.
enum class Definiteness {
  definite,    ///< can be inverted
  singular,    ///< zero to the data's own digits: never to be inverted
  indefinite,  ///< negative beyond the data's digits: modes and D_P contradict each other
};

/// D_P0 = D_P - L_P'L_P, the residual mass at P: the rigid mass without that of the modes; it must
/// not be negative.
struct ResidualMass {
  Matrix6 D_P0 = Matrix6::Zero();
  double smallest = 0;  ///< smallest eigenvalue with D_P scaled to a unit diagonal: a fraction
  int component = 0;    ///< 0..5, where most of its eigenvector is
  double noise = 0;     ///< below this fraction it counts as zero, by data.digits
  Definiteness verdict = Definiteness::definite;
};
ResidualMass residual_mass(const ModalData& data);

/// Phi_C has rank below 6 if the modes cannot produce six independent motions of C (fewer than
/// six modes, lumped or planar models). A degree of freedom that is blocked can be neither locked
/// nor driven by an acceleration.
struct ChildRank {
  std::string child;
  int rank = 0;                      ///< 0..6
  double condition = 0;              ///< of the rows scaled to length 1, without the blocked ones
  std::vector<std::string> blocked;  ///< "rx", or a combination "y - 0.5 rz" that does not move
};
ChildRank child_rank(const ModalData& data, const ModalChild& child);

/// The same of a whole line: the six channels of its child, none for the line of the parent, and
/// one per shape. `weld` of a child's line to a point locks all of them, `ground` of a parent's
/// line its shapes. With fewer modes than channels the rank is at most the number of modes.
struct LineRank {
  std::string line;
  int channels = 0;
  int rank = 0;                      ///< 0..channels
  double condition = 0;              ///< of the rows scaled to length 1, without the blocked ones
  std::vector<std::string> blocked;  ///< "z3", or a combination "z - 0.5 z2" that does not move
};
LineRank line_rank(const ModalData& data, const ModalLine& line);

/// "rx", or a combination "y - 0.5 rz".
std::string combination(const Vector6& w);

/// Accuracy of the block's numbers (graph/data_digits.hpp): sizes of a child are its largest row
/// norms of Phi_C, of translations and of rotations, made comparable by the distance from P; those
/// of a line's shapes the largest of their row norms and of its child's, made comparable by its
/// length; those of P the square roots of D_P's diagonal; the fraction of `mass` follows from
/// `data.digits`, that of `shapes` is 1e-11 or more, the rounding of an eigenproblem.
DataDigits data_digits(const ModalData& data);

/// fraction(k, j) = L_P(k, j)^2 / D_P(j, j): fraction of the rigid mass that moves with mode k if P
/// is accelerated along component j. Zero if D_P(j, j) is.
struct EffectiveMass {
  Eigen::MatrixXd fraction;         ///< N x 6
  Vector6 total = Vector6::Zero();  ///< their sums; 1 - total remains in D_P0
};
EffectiveMass effective_mass(const ModalData& data);

/// Legal values that are probably mistakes, one line each, with its number: a damping ratio above
/// 0.2, a lowest frequency below 1e-4 Hz or above 1e6 Hz.
std::vector<std::string> implausible(const ModalData& data);

/// The same of a Young's modulus below 1e8 Pa: one in MPa, of data in mm, t, s.
std::vector<std::string> implausible_modulus(double E);

/// The checks above for one body.
struct ModalReport {
  Eigen::VectorXd omega;  ///< [rad/s]
  MassProperties mass;
  ResidualMass residual;
  std::vector<ChildRank> children;
  EffectiveMass effective;
  std::vector<std::string> implausible;
  std::vector<LineRank> lines = {};
};
/// All of the above. Cost 100 N, and N c^2 for each line of c channels.
ModalReport modal_report(const ModalData& data);

/// One fact per line; the modes with the largest effective masses only.
std::string to_string(const ModalReport& report);

/// "x", "y", "z", "rx", "ry", "rz" for component 0..5.
const char* component_name(int component);

}  // namespace titop
