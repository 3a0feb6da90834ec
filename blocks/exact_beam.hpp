#pragma once

#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/rigid_body.hpp>

namespace titop {

/// A uniform beam without elements: Euler-Bernoulli bending in two planes, rod and shaft, from P at
/// the origin to C at (length, 0, 0), as `Beam`. Its partial differential equations are solved in
/// closed form at every s, with all of its infinitely many modes:
///
///     m (s (s + mass) v + s^2 R x_P) + (1 + stiffness s) E I v'''' = 0
///
/// v is the deflection relative to the rigid motion R x_P of P, m = rho area, and `damping` has the
/// coefficients mass [1/s] (relative to P, as Rayleigh damping of modes) and stiffness [s]
/// (Kelvin-Voigt: E and G times 1 + stiffness s). `Beam` with the same `ModeOptions::rayleigh`
/// converges to it with more elements; a constant damping ratio of all modes has no closed form.
///
/// Ports as of FlexibleBody{Beam{...}}: child "C" takes a wrench, parent an acceleration. It has no
/// finite state space: `System::transfer` and `frequency_response` compute it, in every precision;
/// `state_space`, `poles`, `simulate` and all that needs them throw not_rational. `with_elements`
/// divides it into elements, `compare` (analysis/distributed) estimates the error of that.
///
/// `add` throws bad_value, as check(Beam), and for damping < 0; transfer throws singular at a pole
/// of the beam clamped at P. Cost at one s: some 10 us in double.
struct ExactBeam {
  double length = 0;  ///< [m]
  Section section = {};
  Material material = {};
  fe::Rayleigh damping = {};

  using Handle = BodyHandle;
};
BlockPtr as_block(const ExactBeam& beam);

/// The same beam divided into elements of equal length, with the same damping. `modes`: number of
/// modes and residual vectors; its damping is not used.
Beam with_elements(const ExactBeam& beam, int elements, fe::ModeOptions modes = {});

}  // namespace titop
