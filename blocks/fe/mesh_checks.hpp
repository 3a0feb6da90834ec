#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <vector>

/// Quality of the matrices of a mesh, before any modes are computed.
namespace titop::fe {

/// Mass properties and rigid-body check of a mesh, in its own units.
struct MeshReport {
  MassProperties mass;  ///< from R'MR about the origin: mass properties of M
  /// From the points alone: the mass that M assigns to each (its row sums over one direction) at
  /// the point's position. The inertia leaves out the points' own rotary inertia and the
  /// distribution between points; mass and centre must agree with `mass`. Absent if the masses of
  /// some point along x, y and z differ, and for generalised coordinates (Craig-Bampton), whose
  /// mass is not at the points.
  std::optional<MassProperties> geometry;
  double KR = 0;         ///< largest |K R| / largest |K|, R about the origin [m]: 0 for a free mesh
  double KR_terms = 0;   ///< largest |K R| relative to the terms that cancel in it, a term K(i, j)
                         ///< R(j) counted as sqrt(K(i, i) K(j, j)) |R at j's point|: independent of
                         ///< units and of the grids' frames; at the data's digits if the positions
                         ///< fit the matrices of a free mesh
  std::string KR_worst;  ///< degree of freedom of that entry
  double asymmetry = 0;  ///< `asymmetry(mesh)`
};

/// Resistance of K to rigid motion, which should be 0: KR, KR_terms and KR_worst of the report.
struct RigidStiffness {
  double of_largest = 0, of_terms = 0;
  std::string worst;
};
/// K must not be empty. Cost 12 n^2.
RigidStiffness rigid_stiffness(const Mesh& mesh);

/// Checks the mesh and computes its mass properties. Throws the errors of `check`. Cost 12 n^2.
MeshReport mesh_report(const Mesh& mesh);

/// Legal values that are probably mistakes, one line each, with its number: a centre of mass of M
/// that differs from that of the points by more than 1 % of the radius of gyration.
std::vector<std::string> implausible(const MeshReport& report);

/// One fact per line, `implausible` at the end. In SI if `units`, those of the mesh, are given; the
/// numbers of the mesh otherwise, without units.
std::string to_string(const MeshReport& report, const std::optional<DataUnits>& units = {});

/// Effect of rounded digits of M and K: relative standard deviation of each clamped omega if every
/// entry of both has a random relative error of 10^-digits,
///
///     d(omega^2) = v' dK v - omega^2 v' dM v,    v'Mv = 1
///
/// Modes clamped at `parent`, the `count` lowest. Large for slender solid meshes, whose bending
/// stiffness is a small difference of large entries. Throws the errors of `check`, `interface_rows`
/// and `eigh_lowest`. Cost 20 n^3.
Eigen::VectorXd omega_uncertainty(const Mesh& mesh, const std::string& parent, int count);

}  // namespace titop::fe
