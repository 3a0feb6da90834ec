#pragma once

#include <string>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>

/// Plates of aluminium with lines at their edges, whose shapes are Legendre polynomials.
namespace panels {

inline titop::fe::Mesh panel(double a, int along_x, int along_y) {
  return titop::plate_mesh({.a = a,
                            .b = 0.6,
                            .thickness = 0.004,
                            .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                            .elements = {along_x, along_y}});
}

inline titop::fe::Coupling shapes(const titop::fe::Mesh& mesh, const std::string& edge) {
  constexpr int kPolynomials = 4;
  return titop::fe::shapes(titop::fe::edge(mesh, edge), titop::fe::legendre(kPolynomials));
}

/// Held along a part of an edge, so that it bends and twists; "next" is its other end.
inline titop::fe::Mesh inner() {
  using namespace titop::fe;
  const Mesh mesh = panel(0.8, 2, 3);
  const Mesh held = with_interface(mesh, "root", rigid(segment(mesh, "x0", 0, 1.0 / 3)));
  return with_interface(held, "next", panels::shapes(held, "x1"));
}

}  // namespace panels
