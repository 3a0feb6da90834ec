#pragma once

#include <optional>
#include <string>
#include <titop/blocks/fe/material.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <vector>

namespace titop {

/// Cross-section of a beam along x; y and z are its principal axes through the centroid, which is
/// also the shear centre.
struct Section {
  double area = 0;                 ///< [m^2]
  double I_y = 0;                  ///< integral of z^2: bending in the x-z plane [m^4]
  double I_z = 0;                  ///< integral of y^2: bending in the x-y plane [m^4]
  double J = 0;                    ///< torsion constant (Saint-Venant) [m^4]
  std::optional<double> I_x = {};  ///< polar moment, torsional inertia per rho [m^4]; I_y + I_z
};

/// Solid rectangle; J by the series of [Timoshenko 1951, Theory of Elasticity, art. 109] to machine
/// precision. Dimensions in m. Throws `bad_value` unless positive.
Section rectangle(double width_y, double height_z);

/// Solid circle. [m] Throws `bad_value` unless positive.
Section circle(double diameter);

/// Circular tube. [m] Throws `bad_value` unless outer > inner >= 0.
Section tube(double outer_diameter, double inner_diameter);

/// Uniform three-dimensional Euler-Bernoulli beam from P at the origin to C at (length, 0, 0):
/// axial, torsion and two bendings, no shear deformation and no rotary inertia of bending.
///
///     Beam{.length = 2.0, .section = rectangle(0.06, 0.04),
///          .material = {.E = 70e9, .nu = 0.33, .rho = 2700}, .modes = {.xi = {0.005}}}
struct Beam {
  double length = 0;  ///< [m]
  Section section = {};
  Material material = {};
  int elements = 10;           ///< of equal length
  fe::ModeOptions modes = {};  ///< which modes are kept, residual vectors ("C", "P"), damping
};

/// Throws `bad_value`, all mistakes together: values that are not positive and finite, fewer than
/// one element, a Poisson's ratio of -1 or less or above 0.5, a material with both or neither of nu
/// and G.
void check(const Beam& beam);

/// Legal values that are probably mistakes, one line each, with its number: E below 1e8 Pa (data in
/// MPa). In Mesh::warnings, and so in the log of `compile`.
std::vector<std::string> implausible(const Beam& beam);

/// Free mesh of elements + 1 points "0", "1", ... along x, six degrees of freedom each, and the
/// interfaces "P" (first) and "C" (last). Linear shapes for axial and torsion, cubic ones for
/// bending, consistent mass [Przemieniecki 1968, ch. 5 and 11]: frequencies converge from above,
/// the relative error of an omega falls with h^4 in bending and h^2 in axial and torsion.
fe::Mesh beam_mesh(const Beam& beam);

/// Modes clamped at P with the child C: fe::modal_data(beam_mesh(beam), "P", {"C"}, beam.modes).
/// For other interfaces call that. All 6 * elements modes unless beam.modes selects others.
ModalData modal_data(const Beam& beam);

}  // namespace titop
