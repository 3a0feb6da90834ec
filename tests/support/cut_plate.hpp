#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

/// A square plate clamped along x = 0, in two halves that are welded along a cut by a few
/// polynomials. Frequencies are omega a^2 sqrt(rho h / D), nu = 0.3.
namespace titop_test {

titop::fe::Mesh half_plate(int along_x, int along_y);

/// Row of this component (titop::fe::Dof) at this point; -1: there is none.
Eigen::Index row_of(const titop::fe::Mesh& mesh, std::size_t point, int component);
/// Rows of the interface's point (z, rx, ry), then of its shapes.
std::vector<Eigen::Index> rows_of(const titop::fe::Mesh& mesh, const std::string& name);

/// Frequencies of halves of along_x x along_y elements before the cut and along_x x behind after
/// it, with m polynomials each for deflection and slope: of equal displacements along the cut
/// (restricted: above the exact ones) or of equal moments of them (below).
Eigen::VectorXd cut_plate(int along_x, int along_y, int behind, int m, bool restricted);

}  // namespace titop_test
