#pragma once

#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/port_hamiltonian.hpp>

namespace titop {

/// Eq. (7): q = stretch, p = m times its rate. Parameters at their nominal values; the spec is not
/// checked.
PortHamiltonian port_hamiltonian(const SpringMass& spec);
/// Eq. (17) in modal coordinates. Parameters at their nominal values. Throws not_rational for a
/// body with a loss factor.
PortHamiltonian port_hamiltonian(const FlexibleBody& body);

}  // namespace titop
