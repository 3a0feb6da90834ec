#pragma once

#include <array>
#include <optional>
#include <string>
#include <titop/blocks/fe/material.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

namespace titop {

/// Bending stiffness of an orthotropic plate whose principal axes are x and y: moments per length
/// M_x = D11 w_xx + D12 w_yy, M_y = D12 w_xx + D22 w_yy, M_xy = 2 D66 w_xy. [N m] For sandwiches
/// and laminates; D11 = D22 = D, D12 = nu D, D66 = (1 - nu) D / 2 with
/// D = E thickness^3 / (12 (1 - nu^2)) is the isotropic one.
struct PlateStiffness {
  double D11 = 0, D12 = 0, D22 = 0, D66 = 0;
};

/// Stiffness in the plane of an orthotropic plate: forces per length N_x = A11 u_x + A12 v_y,
/// N_y = A12 u_x + A22 v_y, N_xy = A66 (u_y + v_x). [N/m] A11 = A22 = A, A12 = nu A,
/// A66 = (1 - nu) A / 2 with A = E thickness / (1 - nu^2) is the isotropic one.
struct MembraneStiffness {
  double A11 = 0, A12 = 0, A22 = 0, A66 = 0;
};

/// Motion of a plate in its plane.
enum class InPlane { rigid, membrane };

/// Rectangular plate of uniform thickness in the plane z = 0, 0 <= x <= a, 0 <= y <= b: Kirchhoff's
/// thin plate, no shear deformation and no rotary inertia. It bends along z, rx, ry; in its plane
/// (x, y, rz) it is rigid, or an elastic membrane in plane stress.
///
///     Plate panel{.a = 2.0, .b = 1.0, .thickness = 0.02,
///                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700}, .elements = {8, 4}};
///     fe::Mesh mesh = plate_mesh(panel);
///     auto p1 = d.add("p1", FlexibleBody{fe::modal_data(mesh, "0,2", {"8,2"}, {.kept = 10})});
struct Plate {
  double a = 0, b = 0;                   ///< sides along x and y [m]
  double thickness = 0;                  ///< [m]
  Material material = {};                ///< isotropic; with D its rho alone
  std::optional<PlateStiffness> D = {};  ///< in place of E, nu, G
  std::array<int, 2> elements = {8, 8};  ///< along x and y, of equal size
  InPlane in_plane = InPlane::rigid;
  std::optional<MembraneStiffness> A = {};  ///< of a membrane with D; else by E, nu, G
};

/// Throws `bad_value`, all mistakes together: values that are not positive and finite, fewer than
/// one element, more than 63 x 63, with a membrane 51 x 51 (M and K of 2.1 GB each), a material
/// with both or neither of nu and G, a Poisson's ratio, given or by E / (2 G) - 1, of -1 or less or
/// above 0.5, a D or A that is not positive definite, E, nu or G beside D, a membrane with one of D
/// and A alone, A of a plate that is rigid in its plane.
void check(const Plate& plate);

/// Legal values that are probably mistakes, one line each, with its number: E below 1e8 Pa (data in
/// MPa), a thickness above a tenth of the shorter side (a thin plate's frequencies are then too
/// high).
std::vector<std::string> implausible(const Plate& plate);

/// Free mesh of (elements + 1) nodes a side, "i,j" counted from 0 along x and y, with z, rx, ry and
/// wxy each, and the edges "x0", "x1" (x = 0, x = a; along y), "y0", "y1" (along x). Bicubic
/// Hermite functions [Bogner, Fox and Schmit 1965]: w, w_x = -ry, w_y = rx and w_xy are continuous,
/// the mass is consistent; frequencies converge from above, the relative error of an omega falls
/// with h^4. Mesh::rigid is the plate's mass. An interface at one node transmits z, rx, ry there
/// and leaves wxy free: clamped or loaded by a moment at one node, a plate does not converge with
/// the mesh (its slope there grows with the logarithm of 1/h). Dense: 4 (elements + 1)^2 rows.
///
/// A membrane adds x and y to every node: bilinear functions [Zienkiewicz and Taylor 2000],
/// integrated exactly, conforming; frequencies in the plane converge from above, the relative error
/// of an omega falls with h^2: (k h)^2 / 24 of a wave of wave number k along an axis. It shares no
/// row of K with bending. Nodes have no rz: parent and children are interfaces of several nodes
/// (fe::rigid, fe::average, lines), and a single one is refused by `modal_data`. 6 (elements + 1)^2
/// rows.
fe::Mesh plate_mesh(const Plate& plate);

}  // namespace titop
