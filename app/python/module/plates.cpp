#include "python.hpp"

namespace titop::python {
namespace {

void bind_plate(py::module_& m) {
  py::class_<PlateStiffness>(m, "PlateStiffness",
                             "Bending stiffness of an orthotropic plate of axes x and y [N m]: M_x "
                             "= D11 w_xx + D12 w_yy, M_y = D12 w_xx + D22 w_yy, M_xy = 2 D66 w_xy.")
      .def(py::init([](double D11, double D12, double D22, double D66) {
             return PlateStiffness{D11, D12, D22, D66};
           }),
           "D11"_a, "D12"_a, "D22"_a, "D66"_a)
      .def_readonly("D11", &PlateStiffness::D11, "M_x by w_xx [N m].")
      .def_readonly("D12", &PlateStiffness::D12, "M_x by w_yy, and M_y by w_xx [N m].")
      .def_readonly("D22", &PlateStiffness::D22, "M_y by w_yy [N m].")
      .def_readonly("D66", &PlateStiffness::D66, "Half of M_xy by w_xy [N m].");
  py::class_<MembraneStiffness>(
      m, "MembraneStiffness",
      "Stiffness in the plane of an orthotropic plate [N/m]: N_x = A11 u_x + A12 v_y, N_y = A12 "
      "u_x + A22 v_y, N_xy = A66 (u_y + v_x).")
      .def(py::init([](double A11, double A12, double A22, double A66) {
             return MembraneStiffness{A11, A12, A22, A66};
           }),
           "A11"_a, "A12"_a, "A22"_a, "A66"_a)
      .def_readonly("A11", &MembraneStiffness::A11, "N_x by u_x [N/m].")
      .def_readonly("A12", &MembraneStiffness::A12, "N_x by v_y, and N_y by u_x [N/m].")
      .def_readonly("A22", &MembraneStiffness::A22, "N_y by v_y [N/m].")
      .def_readonly("A66", &MembraneStiffness::A66, "N_xy by the shear u_y + v_x [N/m].");
  py::class_<Plate>(m, "Plate",
                    "Rectangular thin plate (Kirchhoff) in the plane z = 0, 0 <= x <= a, 0 <= y <= "
                    "b [m], of this thickness [m]: it bends along z, rx, ry; in_plane it is "
                    "\"rigid\" or a \"membrane\". D: PlateStiffness in place of E, nu, G, and A: "
                    "MembraneStiffness of a membrane with D. elements: along x and y.")
      .def(py::init([](double a, double b, double thickness, const Material& material,
                       const std::optional<PlateStiffness>& D, const std::array<int, 2>& elements,
                       const std::string& in_plane, const std::optional<MembraneStiffness>& A) {
             return Plate{
                 a,
                 b,
                 thickness,
                 material,
                 D,
                 elements,
                 named<InPlane>(in_plane, "in_plane",
                                {{"rigid", InPlane::rigid}, {"membrane", InPlane::membrane}}),
                 A};
           }),
           py::kw_only(), "a"_a, "b"_a, "thickness"_a, "material"_a, "D"_a = py::none(),
           "elements"_a = std::array<int, 2>{8, 8}, "in_plane"_a = "rigid", "A"_a = py::none())
      .def_readonly("a", &Plate::a, "Side along x [m].")
      .def_readonly("b", &Plate::b, "Side along y [m].")
      .def_readonly("thickness", &Plate::thickness, "[m]")
      .def_readonly("material", &Plate::material, "Its Material; with D only its rho counts.")
      .def_readonly("D", &Plate::D, "PlateStiffness in place of E, nu, G; else None.")
      .def_readonly("elements", &Plate::elements, "Numbers of equal elements along x and y.")
      .def_property_readonly(
          "in_plane",
          [](const Plate& p) { return p.in_plane == InPlane::rigid ? "rigid" : "membrane"; },
          "\"rigid\", or elastic in its plane: \"membrane\".")
      .def_readonly("A", &Plate::A, "MembraneStiffness of a membrane with D; else None.");
}

void bind_node_sets(py::module_& m) {
  py::class_<fe::NodeSet>(m, "NodeSet", "Nodes of a mesh with their weights, for an interface.")
      .def_readonly("name", &fe::NodeSet::name, "For messages, \"edge x1\".")
      .def_property_readonly(
          "points", [](const fe::NodeSet& s) { return s.points; }, "Places in the mesh's points.")
      .def_readonly("weights", &fe::NodeSet::weights, "One per node, > 0.");
  m.def("nodes", &fe::nodes, "mesh"_a, "names"_a,
        "The points or interfaces of these names, with equal weights.");
  m.def("box", &fe::box, "mesh"_a, "low"_a, "high"_a,
        "All points with degrees of freedom in the box of these corners [m], with equal weights.");
  m.def("edge", &fe::edge, "mesh"_a, "name"_a,
        "The named edge, of a plate \"x0\", \"x1\" (x = 0, x = a; along y), \"y0\", \"y1\"; "
        "weights by the trapezoidal rule.");
  m.def("segment",
        py::overload_cast<const fe::Mesh&, const std::string&, double, double>(&fe::segment),
        "mesh"_a, "edge"_a, "from_"_a, "to"_a,
        "The nodes of the edge between these fractions of its length, at which it has nodes.");
  m.def("segment",
        py::overload_cast<const fe::Mesh&, const Vector3d&, const Vector3d&>(&fe::segment),
        "mesh"_a, "A"_a, "B"_a, "All points on the straight line from A to B [m].");
}

void bind_couplings(py::module_& m) {
  py::class_<fe::Legendre>(m, "Legendre", "Legendre polynomials along an edge.")
      .def_readonly("count", &fe::Legendre::count,
                    "Number of polynomials, of degrees 0 to count - 1.");
  m.def("legendre", &fe::legendre, "m"_a,
        "m Legendre polynomials of degrees 0 to m - 1 for each displacement of an edge and its "
        "rotation about it.");
  py::class_<fe::Coupling>(m, "Coupling", "How an interface follows its nodes.")
      .def_readonly("nodes", &fe::Coupling::nodes, "The NodeSet.")
      .def_readonly("count", &fe::Coupling::count, "Polynomials of shapes and moments.");
  m.def("rigid", &fe::rigid, "nodes"_a,
        "The nodes move as one rigid body (RBE2): frequencies rise.");
  m.def("average", py::overload_cast<fe::NodeSet>(&fe::average), "nodes"_a,
        "The point moves as the nodes' weighted mean (RBE3): frequencies fall.");
  m.def("average", py::overload_cast<fe::NodeSet, const std::vector<double>&>(&fe::average),
        "nodes"_a, "weights"_a, "The same with other weights, one per node.");
  m.def("shapes", &fe::shapes, "edge"_a, "polynomials"_a,
        "The edge moves by these shapes alone: frequencies rise.");
  m.def("moments", &fe::moments, "edge"_a, "polynomials"_a,
        "Coefficients of the edge's motion by these shapes; the rest is free: frequencies fall.");
  m.def("with_interface", &fe::with_interface, "mesh"_a, "name"_a, "coupling"_a, Unlocked(),
        "The mesh with this interface of many nodes: a point at their weighted centre, and of "
        "shapes and moments one coordinate for each shape of the edge.");
}

}  // namespace

void bind_plates(py::module_& m) {
  py::module_ fe = m.attr("fe");
  bind_plate(m);
  fe.def("plate_mesh", &plate_mesh, "plate"_a, Unlocked(),
         "The free mesh of a plate: nodes \"i,j\" counted from 0 along x and y, with z, rx, ry and "
         "wxy each, and the edges x0, x1, y0, y1. M and K [SI], 4 (elements + 1)^2 rows.");
  bind_node_sets(fe);
  bind_couplings(fe);
}

}  // namespace titop::python
