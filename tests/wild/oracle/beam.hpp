#pragma once

#include <string>
#include <vector>

#include "wild/oracle/scene.hpp"

namespace wild {

/// A finite-element beam in the coordinates (motion of its parent point; elastic displacements
/// relative to that, or amplitudes of the kept modes): mass, damping, stiffness, and the motion of
/// each site.
struct BeamModel {
  using Real = long double;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix M, D, K;
  std::vector<Matrix> sites;  ///< 6 x coordinates
  double fastest = 0;         ///< largest natural frequency of the clamped beam [rad/s]
  std::string none;           ///< why the kept modes are not defined; empty: they are
};

/// Euler-Bernoulli elements by quadrature of their shape functions; a group of degrees of freedom
/// that no other moves (axial, torsion, two bendings) has its own eigenvalue problem.
BeamModel beam_model(const Beam& beam);

}  // namespace wild
