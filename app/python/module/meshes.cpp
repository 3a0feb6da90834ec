#include "python.hpp"

namespace titop::python {
namespace {

/// The component "x", "y", "z", "rx", "ry", "rz"; ValueError for another name.
int component_of(const std::string& name) {
  return named<int>(name, "a component",
                    {{"x", 0}, {"y", 1}, {"z", 2}, {"rx", 3}, {"ry", 4}, {"rz", 5}});
}

fe::Mesh mesh_by_hand(const std::string& name, const py::dict& points,
                      const std::vector<std::pair<std::string, std::string>>& dofs,
                      const py::object& M, const py::object& K, const py::dict& interfaces,
                      const py::dict& edges, double digits, const std::optional<Matrix6>& rigid) {
  fe::Mesh mesh;
  mesh.name = name, mesh.digits = digits, mesh.rigid = rigid;
  mesh.M = real_array(M, "M of Mesh");
  mesh.K = real_array(K, "K of Mesh", "; structural damping is FlexibleBody.with_loss_factor(eta)");
  for (const auto& [point, place] : points)
    mesh.points.push_back({taken<std::string>(point, "the name of a point"),
                           taken<Vector3d>(place, "a point's vector of 3 [m]")});
  for (const auto& [point, component] : dofs)
    mesh.dofs.push_back({fe::find_point(mesh, point), component_of(component)});
  for (const auto& [edge, names] : edges) {
    fe::MeshEdge along{taken<std::string>(edge, "the name of an edge"), {}};
    for (const auto& point : taken<std::vector<std::string>>(names, "an edge's list of points"))
      along.points.push_back(fe::find_point(mesh, point));
    mesh.edges.push_back(along);
  }
  for (const auto& [interface, point] : interfaces)
    mesh.interfaces.push_back({taken<std::string>(interface, "the name of an interface"),
                               fe::find_point(mesh, taken<std::string>(point, "a point's name"))});
  check(mesh);
  return mesh;
}

}  // namespace

void bind_meshes(py::module_& m) {
  py::class_<fe::Mesh>(
      m, "Mesh",
      "A finite-element model, free in space: points {name: position [m]}, dofs [(point, \"x\", "
      "\"y\", \"z\", \"rx\", \"ry\" or \"rz\")], one per row of M [kg, kg m, kg m^2] and K "
      "[N/m, N, N m] (n x n), interfaces {name: point}, edges {name: [points in order]}, decimal "
      "digits of M and K; of planar models the rigid mass matrix (6 x 6) about the origin.")
      .def(py::init(&mesh_by_hand), py::kw_only(), "name"_a = "mesh", "points"_a, "dofs"_a, "M"_a,
           "K"_a, "interfaces"_a = py::dict(), "edges"_a = py::dict(), "digits"_a = 15.0,
           "rigid"_a = py::none())
      .def_readonly("name", &fe::Mesh::name, "For messages.")
      .def_property_readonly(
          "points",
          [](const fe::Mesh& mesh) {
            py::dict result;
            for (const fe::MeshPoint& p : mesh.points) result[py::str(p.name)] = p.position;
            return result;
          },
          "{name: position [m]}, in the body's frame.")
      .def_property_readonly(
          "dofs",
          [](const fe::Mesh& mesh) {
            std::vector<std::string> names;
            for (Eigen::Index i = 0; i < mesh.M.rows(); ++i) names.push_back(dof_name(mesh, i));
            return names;
          },
          "Names of the rows of M and K, \"17.x\".")
      .def_property_readonly(
          "interfaces",
          [](const fe::Mesh& mesh) {
            py::dict result;
            for (const fe::MeshInterface& i : mesh.interfaces)
              result[py::str(i.name)] = mesh.points[i.point].name;
            return result;
          },
          "{name: point}.")
      .def_readonly("M", &fe::Mesh::M, "n x n [kg, kg m, kg m^2].")
      .def_readonly("K", &fe::Mesh::K, "n x n [N/m, N, N m].")
      .def_readonly("digits", &fe::Mesh::digits, "Decimal digits of M and K.");
  m.def(
      "read_calculix",
      [](const std::filesystem::path& stem, const std::map<std::string, int>& interfaces) {
        std::vector<fe::CalculixInterface> list;
        for (const auto& [name, node] : interfaces) list.push_back({name, node});
        return fe::read_calculix(fe::calculix_files(stem), list);
      },
      "stem"_a, "interfaces"_a, Unlocked(),
      "The free mesh of stem.sti, .mas, .dof and .inp (*FREQUENCY, SOLVER=MATRIXSTORAGE); "
      "interfaces {name: reference node}.");
  m.def("beam_mesh", &beam_mesh, "beam"_a, "The free mesh of a beam, interfaces P and C.");
  m.def(
      "modal_data",
      [](const fe::Mesh& mesh, const std::string& parent, const std::vector<std::string>& children,
         const fe::ModeOptions& modes) { return fe::modal_data(mesh, parent, children, modes); },
      "mesh"_a, "parent"_a, "children"_a, "modes"_a = fe::ModeOptions(), Unlocked(),
      "Modes of the mesh clamped at the interface `parent`.");
  m.def(
      "modal_data", [](const Beam& beam) { return modal_data(beam); }, "beam"_a,
      "Modes of a beam clamped at P with the child C.");
  m.def(
      "mesh_report", [](const fe::Mesh& mesh) { return to_string(fe::mesh_report(mesh)); },
      "mesh"_a, "Mass properties and rigid-body check as text.");
  m.def(
      "modal_report", [](const ModalData& data) { return to_string(modal_report(data)); }, "data"_a,
      "Mass, residual mass, rank of children and lines, effective masses as text.");
}

}  // namespace titop::python
