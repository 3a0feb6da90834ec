#pragma once

#include <Eigen/Core>
#include <titop/graph/state_space.hpp>

namespace titop {

/// A port-Hamiltonian system, [Alazard 2015] eqs (7) and (17), with x = [q; p]:
///
///     H = x' Q x / 2,    xdot = (J - R) Q x + G u,    y = N pdot + P u
///
/// J skew, R symmetric and positive semidefinite. For modes q = eta and p = etadot (17 in modal
/// coordinates, valid for any number of kept modes). The energy is that of the motion relative to
/// P: dH/dt = (Q x)' G u - (Q x)' R (Q x), damping never adds any.
struct PortHamiltonian {
  Eigen::MatrixXd Q;  ///< 2n x 2n, Hessian of H
  Eigen::MatrixXd J;  ///< 2n x 2n, interconnection
  Eigen::MatrixXd R;  ///< 2n x 2n, dissipation
  Eigen::MatrixXd G;  ///< 2n x inputs
  Eigen::MatrixXd N;  ///< outputs x n
  Eigen::MatrixXd P;  ///< outputs x inputs

  /// H [J]. These throw size for vectors of another size.
  double energy(const Eigen::VectorXd& x) const;
  /// Power at the ports, (Q x)' G u [W]; dH/dt = supplied - dissipated.
  double supplied(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const;
  /// (Q x)' R (Q x) >= 0 [W].
  double dissipated(const Eigen::VectorXd& x) const;
  /// A, B, C, D of the same system in the coordinates x, without names.
  StateSpace state_space() const;
};

namespace detail {
/// J = [0, I; -I, 0] and R = diag(0, damping), n x n; nothing else.
PortHamiltonian canonical(const Eigen::MatrixXd& damping);
}  // namespace detail

}  // namespace titop
