#pragma once

#include <titop/graph/diagram.hpp>

/// Four-bar linkages in the plane z = 0 from the origin.
namespace titop_test {

struct FourBar {
  double crank, coupler, rocker;     ///< lengths [m]
  double crank_angle, rocker_angle;  ///< from x [rad]
  titop::Vector3d base;              ///< of the rocker

  static constexpr double kStiffness = 5;  ///< of the crank's spring [N m/rad]
};

/// The coupler is along x. From the torque "u" on the crank, which has a spring, to the angles
/// "crank" and "rocker".
titop::Diagram diagram(const FourBar& f);

/// Turned by this angle out of its folded posture, in which it is singular. A crank of 0.3 m.
inline FourBar parallelogram(double angle) { return {0.3, 1, 0.3, angle, angle, {1, 0, 0}}; }

}  // namespace titop_test
