#include <doctest/doctest.h>

#include <cmath>
#include <titop/analysis/bracket/interface_bracket.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>

/// Two halves of a membrane, welded along the cut, enclose the whole.

using namespace titop;

namespace {

fe::Mesh sheet(double a, int along_x) {
  const fe::Mesh mesh = plate_mesh({.a = a,
                                    .b = 1,
                                    .thickness = 0.002,
                                    .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                    .elements = {along_x, 4},
                                    .in_plane = InPlane::membrane});
  return a == 0.5 ? mesh : fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
}

Diagram halves(Lumping lumping, int m) {
  const auto line = [&](const fe::Mesh& mesh, const char* edge) {
    return lumping == Lumping::constrained ? fe::shapes(fe::edge(mesh, edge), fe::legendre(m))
                                           : fe::moments(fe::edge(mesh, edge), fe::legendre(m));
  };
  const auto body = [](const fe::Mesh& mesh, const char* parent, const char* child) {
    return FlexibleBody{fe::modal_data(mesh, parent, {child})};
  };
  fe::Mesh a = sheet(0.5, 2), b = a;
  a = fe::with_interface(a, "root", fe::rigid(fe::edge(a, "x0")));
  a = fe::with_interface(a, "next", line(a, "x1"));
  b = fe::with_interface(b, "prev", line(b, "x0"));
  b = fe::with_interface(b, "tip", fe::average(fe::edge(b, "x1")));
  Diagram d{"halves"};
  auto inner = d.add("inner", body(a, "root", "next")),
       outer = d.add("outer", body(b, "prev", "tip"));
  ground(inner);
  weld(outer.line("prev"), inner.line("next"));
  outer.child("tip").force += d.input("F", 6);
  d.output("x", 6) = outer.child("tip").position;
  return d;
}

/// Static compliance along x, y and rz of the whole.
Eigen::Vector3d whole() {
  fe::Mesh mesh = sheet(1, 4);
  mesh = fe::with_interface(mesh, "tip", fe::average(fe::edge(mesh, "x1")));
  const ModalData data = fe::modal_data(mesh, "root", {"tip"});
  const Eigen::MatrixXd& Phi = data.children.at(0).Phi_C;
  const Eigen::MatrixXd soft =
      Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
  return {soft(0, 0), soft(1, 1), soft(5, 5)};
}

}  // namespace

TEST_CASE("two halves of a membrane enclose the whole's compliances in its plane") {
  const Eigen::Vector3d exact = whole();
  for (const int m : {2, 4}) {
    const InterfaceBracket b =
        interface_bracket([&](Lumping l) { return halves(l, m); },
                          {.modes = 4, .compliances = {{0, 0}, {1, 1}, {5, 5}}});
    REQUIRE(b.compliance.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) {
      const double soft = exact(static_cast<Eigen::Index>(k));
      INFO(m << " polynomials, " << k << ": " << b.compliance[k].below << ' ' << soft << ' '
             << b.compliance[k].above);
      CHECK(b.compliance[k].below <= soft * (1 + 1e-9));
      CHECK(b.compliance[k].above >= soft * (1 - 1e-9));
      CHECK(b.compliance[k].width() <= (m == 4 ? 0.01 : 0.2) * soft);
    }
  }
}
