#pragma once

// Two beams with all of their modes, and one of them clamped.
#include <cmath>
#include <complex>
#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

namespace exact_beams {

using titop::BodyHandle;
using titop::Diagram;
using titop::ExactBeam;
using titop::Vector3d;
using Complex = std::complex<double>;

inline const Vector3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Numbers that are exact in double, so that products of three are, too: beta L is sqrt(omega).
inline ExactBeam unit_beam() {
  return {.length = 1,
          .section = {.area = 1, .I_y = 1, .I_z = 0.0625, .J = 0.25, .I_x = 2},
          .material = {.E = 1, .G = 0.5, .rho = 1}};
}

inline ExactBeam boom(const titop::fe::Rayleigh& damping = {}) {
  return {.length = 3,
          .section = {.area = 1e-3, .I_y = 4e-7, .I_z = 2.5e-7, .J = 5e-7, .I_x = 6.5e-7},
          .material = {.E = 70e9, .G = 27e9, .rho = 2700},
          .damping = damping};
}

/// omega of the softer plane at this beta L.
inline double omega_at(const ExactBeam& b, double beta_L) {
  const double I = std::min(b.section.I_y, b.section.I_z);
  return beta_L * beta_L * std::sqrt(b.material.E * I / (b.material.rho * b.section.area)) /
         (b.length * b.length);
}

inline void drive_end(Diagram& d, BodyHandle& b) {
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
}

inline Diagram clamped(const ExactBeam& beam) {
  Diagram d{"clamped"};
  auto b = d.add("b", beam);
  b.parent.accel = 0;
  drive_end(d, b);
  return d;
}

}  // namespace exact_beams
