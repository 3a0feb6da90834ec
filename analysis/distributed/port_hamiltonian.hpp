#pragma once

#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/blocks/port_hamiltonian.hpp>

namespace titop {

/// A reduced structure, ReducedSystem::second_order(), as a port-Hamiltonian system with x = [q;
/// p], p = M qd: Q = diag(K, M^-1), R = diag(0, D), G = [0; B], N = C_accel M^-1, P = direct. H is
/// the energy of the kept modes, elastic and kinetic [J]; of a free structure without that of its
/// rigid motion, to which they are orthogonal.
///
/// Of ReducedSystem, Q and R are semidefinite and J is skew for every order, since it is a
/// projection of the full structure: dH/dt <= (Q x)' G u, whatever modes are kept. If outputs are
/// the accelerations of the points and directions of the inputs, N = (lower half of G)', and P,
/// which has the rigid motion, is symmetric and semidefinite: Y(s) / s, from forces to rates, is
/// positive real (the structure is passive).
///
/// Throws bad_value for an output that reads a rate, or a position with damping or of a motion
/// without stiffness: y = N pdot + P u has accelerations (and undamped elastic positions) only; for
/// an M that is not positive definite. O(n^3).
PortHamiltonian port_hamiltonian(const SecondOrderModel& model);

}  // namespace titop
