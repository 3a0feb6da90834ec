#include <map>
#include <set>
#include <titop/blocks/fe/mat.hpp>
#include <titop/blocks/fe/op4.hpp>

#include "python.hpp"

namespace titop::python {
namespace {

// Matrices that a script may replace are given away as copies, since a view would outlive its
// memory; read-only ones, since changes of a copy would be lost.
template <class Data, class M>
auto copy_of(M Data::*matrix) {
  return [matrix](const Data& data) { return read_only(py::array(py::cast(M(data.*matrix)))); };
}
template <class Data, class M>
auto set(M Data::*matrix) {
  return [matrix](Data& data, const M& value) { data.*matrix = value; };
}
template <class Data>
auto set_numbers(Eigen::VectorXd Data::*vector) {
  return [vector](Data& data, const Numbers& value) { data.*vector = vector_of(value); };
}

void bind_ports_of_modes(py::module_& m) {
  py::class_<ModalChild>(m, "ModalChild",
                         "A child point of a flexible body: PC from P [m]; Phi_C (6 x N), "
                         "displacements [1/sqrt(kg)] and rotations of the modes there.")
      .def(py::init([](const std::string& name, const Vector3d& PC, const Eigen::MatrixXd& Phi_C) {
             return ModalChild{name, PC, Phi_C};
           }),
           "name"_a, "PC"_a, "Phi_C"_a)
      .def_readwrite("name", &ModalChild::name, "Of the child point.")
      .def_property("PC", copy_of(&ModalChild::PC), set(&ModalChild::PC),
                    "Vector of 3 from P to C, in the body's frame [m].")
      .def_property("Phi_C", copy_of(&ModalChild::Phi_C), set(&ModalChild::Phi_C),
                    "6 x N: displacements at C [1/sqrt(kg)], then rotations [rad/(m sqrt(kg))].");
  py::class_<ModalLine>(
      m, "ModalLine",
      "An edge of a flexible body as an interface: its name (of the child, or of the parent), the "
      "body axis 0, 1, 2 along which it runs, its length [m], shapes [(component 0..5, degree)], "
      "and Phi (shapes x N), their coordinates in the modes [1/sqrt(kg), rad/(m sqrt(kg))].")
      .def(py::init([](const std::string& name, int axis, double length,
                       const std::vector<std::pair<int, int>>& shapes, const Eigen::MatrixXd& Phi) {
             ModalLine line{name, axis, length, {}, Phi};
             for (const auto& [component, degree] : shapes)
               line.shapes.push_back({component, degree});
             return line;
           }),
           "name"_a, "axis"_a, "length"_a, "shapes"_a, "Phi"_a)
      .def_readonly("name", &ModalLine::name,
                    "Of the child, or of the parent's interface in the mesh.")
      .def_readonly("axis", &ModalLine::axis, "Body axis along which it runs: 0, 1, 2.")
      .def_readonly("length", &ModalLine::length, "[m]")
      .def_property_readonly(
          "shapes",
          [](const ModalLine& l) {
            std::vector<std::pair<int, int>> shapes;
            for (const LineShape& s : l.shapes) shapes.emplace_back(s.component, s.degree);
            return shapes;
          },
          "[(component 0..5, degree of the Legendre polynomial)].")
      .def_property_readonly(
          "Phi", copy_of(&ModalLine::Phi),
          "shapes x N, their coordinates in the modes [1/sqrt(kg), rad/(m sqrt(kg))].");
}

void bind_modal_data(py::module_& m) {
  py::class_<ModalData>(
      m, "ModalData",
      "Modes of a body clamped at P, mass-normalised: omega (N) [rad/s], xi (N) [-], L_P (N x 6) "
      "[sqrt(kg), sqrt(kg) m], D_P (6 x 6) rigid mass matrix about P, children, digits of the "
      "data, lines. The arrays are read-only copies, `children` and `lines` tuples of copies: to "
      "change one, assign a new array or list.")
      .def(py::init([](const Numbers& omega, const Numbers& xi, const Eigen::MatrixXd& L_P,
                       const Matrix6& D_P, const std::vector<ModalChild>& children, double digits,
                       const std::vector<ModalLine>& lines) {
             return ModalData{vector_of(omega), vector_of(xi), L_P, D_P, children, digits, lines};
           }),
           py::kw_only(), "omega"_a, "xi"_a, "L_P"_a, "D_P"_a,
           "children"_a = std::vector<ModalChild>(), "digits"_a = 15.0,
           "lines"_a = std::vector<ModalLine>())
      .def_property("omega", copy_of(&ModalData::omega), set_numbers(&ModalData::omega),
                    "N, natural frequencies clamped at P [rad/s].")
      .def_property("xi", copy_of(&ModalData::xi), set_numbers(&ModalData::xi),
                    "N, damping ratios of these modes [-].")
      .def_property("L_P", copy_of(&ModalData::L_P), set(&ModalData::L_P),
                    "N x 6, participation factors at P [sqrt(kg), sqrt(kg) m].")
      .def_property("D_P", copy_of(&ModalData::D_P), set(&ModalData::D_P),
                    "6 x 6, rigid mass matrix about P [kg, kg m, kg m^2].")
      .def_property(
          "children", [](const ModalData& data) { return py::tuple(py::cast(data.children)); },
          set(&ModalData::children), "A tuple of copies: change one and assign them all.")
      .def_readwrite("digits", &ModalData::digits, "Decimal digits that the data carry.")
      .def_property(
          "lines", [](const ModalData& data) { return py::tuple(py::cast(data.lines)); },
          set(&ModalData::lines), "A tuple of copies.")
      .def_readonly("warnings", &ModalData::warnings, "For the log of compile.");
}

void bind_beams(py::module_& m) {
  py::class_<Section>(m, "Section",
                      "Cross-section of a beam along x: area [m^2], I_y, I_z, J, I_x [m^4].")
      .def(py::init([](double area, double I_y, double I_z, double J, std::optional<double> I_x) {
             return Section{area, I_y, I_z, J, I_x};
           }),
           py::kw_only(), "area"_a, "I_y"_a, "I_z"_a, "J"_a, "I_x"_a = py::none())
      .def_readonly("area", &Section::area, "[m^2]")
      .def_readonly("I_y", &Section::I_y, "Integral of z^2: bending in the x-z plane [m^4].")
      .def_readonly("I_z", &Section::I_z, "Integral of y^2: bending in the x-y plane [m^4].")
      .def_readonly("J", &Section::J, "Torsion constant (Saint-Venant) [m^4].")
      .def_readonly("I_x", &Section::I_x, "Polar moment [m^4]; None: I_y + I_z.");
  m.def("rectangle", &rectangle, "width_y"_a, "height_z"_a, "Section of a solid rectangle [m].");
  m.def("circle", &circle, "diameter"_a, "Section of a solid circle [m].");
  m.def("tube", &tube, "outer_diameter"_a, "inner_diameter"_a, "Section of a circular tube [m].");
  py::class_<Material>(m, "Material",
                       "Isotropic: E [Pa], either Poisson's ratio nu or shear modulus G [Pa], "
                       "density rho [kg/m^3].")
      .def(py::init([](double E, std::optional<double> nu, std::optional<double> G, double rho) {
             return Material{E, nu, G, rho};
           }),
           py::kw_only(), "E"_a = 0.0, "nu"_a = py::none(), "G"_a = py::none(), "rho"_a)
      .def_readonly("E", &Material::E, "Young's modulus [Pa].")
      .def_readonly("nu", &Material::nu, "Poisson's ratio [-]; None if G is given.")
      .def_readonly("G", &Material::G, "Shear modulus [Pa]; None if nu is given.")
      .def_readonly("rho", &Material::rho, "Density [kg/m^3].");
  py::class_<Beam>(m, "Beam",
                   "Uniform Euler-Bernoulli beam from P at the origin to C at (length, 0, 0) [m], "
                   "of equal finite elements; `modes` selects those that are kept.")
      .def(py::init([](double length, const Section& section, const Material& material,
                       int elements, const fe::ModeOptions& modes) {
             return Beam{length, section, material, elements, modes};
           }),
           py::kw_only(), "length"_a, "section"_a, "material"_a, "elements"_a = 10,
           "modes"_a = fe::ModeOptions());
}

void bind_modes(py::module_& m) {
  py::class_<fe::ModeOptions>(
      m, "ModeOptions",
      "Which modes of a mesh are kept: the number of lowest ones (all without it), interfaces with "
      "residual vectors, damping ratios xi (none, one, or one per mode), or Rayleigh damping "
      "(mass [1/s], stiffness [s]); of planar models the rigid mass matrix (6 x 6) about P.")
      .def(py::init([](std::optional<int> kept, const std::vector<std::string>& residual,
                       const std::vector<double>& xi,
                       const std::optional<std::pair<double, double>>& rayleigh,
                       const std::optional<Matrix6>& rigid) {
             fe::ModeOptions o{.kept = kept, .residual = residual, .xi = xi, .rigid = rigid};
             if (rayleigh) o.rayleigh = fe::Rayleigh{rayleigh->first, rayleigh->second};
             return o;
           }),
           py::kw_only(), "kept"_a = py::none(), "residual"_a = std::vector<std::string>(),
           "xi"_a = std::vector<double>(), "rayleigh"_a = py::none(), "rigid"_a = py::none());
}

/// Without requested names, those that are unread or repeat with other values are left out.
std::map<std::string, Eigen::MatrixXd> by_name(const std::vector<fe::Op4Matrix>& all,
                                               const std::vector<std::string>& only) {
  std::map<std::string, Eigen::MatrixXd> result;
  for (const std::string& name : only) {
    const fe::Op4Matrix& matrix = fe::find_matrix(all, name);
    result[matrix.name] = matrix.value;
  }
  if (!only.empty()) return result;
  std::set<std::string> ambiguous;
  for (const fe::Op4Matrix& matrix : all) {
    if (!matrix.unread.empty()) continue;
    const auto [at, is_new] = result.insert({matrix.name, matrix.value});
    if (!is_new && (at->second.rows() != matrix.value.rows() ||
                    at->second.cols() != matrix.value.cols() || at->second != matrix.value))
      ambiguous.insert(matrix.name);
  }
  for (const std::string& name : ambiguous) result.erase(name);
  return result;
}

void bind_readers(py::module_& m) {
  m.def("read_modal_csv", &fe::read_modal_csv, "path"_a, "Modal data of a text file.");
  m.def("modal_csv", &fe::modal_csv, "data"_a, "The same data as such a text.");
  m.def(
      "read_op4",
      [](const std::filesystem::path& path, const std::vector<std::string>& only) {
        return by_name(fe::read_op4(path, only), only);
      },
      "path"_a, "only"_a = std::vector<std::string>(), Unlocked(),
      "{name: matrix} of a file of Nastran's OUTPUT4, or only those of these names; without names, "
      "complex matrices and names that repeat with other values are left out.");
  m.def(
      "read_mat",
      [](const std::filesystem::path& path, const std::vector<std::string>& only) {
        return by_name(fe::read_mat(path), only);
      },
      "path"_a, "only"_a = std::vector<std::string>(), Unlocked(),
      "The same of a MAT-file of MATLAB or Octave (-v6, -v7); names in capitals.");
  m.def(
      "scaled",
      [](const ModalData& data, double length, double mass, double time) {
        return scaled(data, {length, mass, time});
      },
      "data"_a, py::kw_only(), "length"_a = 1.0, "mass"_a = 1.0, "time"_a = 1.0,
      "Data of these units [m], [kg], [s] in SI.");
  py::class_<fe::Import>(m, "Import", "Contents of a file, its checks, and the body.")
      .def_readonly("text", &fe::Import::text, "One fact per line.")
      .def_readonly("ports", &fe::Import::ports, "Grids or points that may be parent or child.")
      .def_readonly("body", &fe::Import::body, "ModalData in SI if a parent was named, else None.");
  m.def(
      "import_body",
      [](const std::filesystem::path& file, const std::string& parent,
         const std::vector<std::string>& children, const fe::ModeOptions& modes,
         const std::array<double, 3>& units, const std::filesystem::path& grids,
         const std::string& stiffness, const std::string& mass) {
        return fe::import_body(file, {.parent = parent,
                                      .children = children,
                                      .units = {units[0], units[1], units[2]},
                                      .modes = modes,
                                      .grids = grids,
                                      .stiffness = stiffness,
                                      .mass = mass});
      },
      "file"_a, py::kw_only(), "parent"_a = "", "children"_a = std::vector<std::string>(),
      "modes"_a = fe::ModeOptions(), "units"_a = std::array<double, 3>{1, 1, 1}, "grids"_a = "",
      "stiffness"_a = "", "mass"_a = "", Unlocked(),
      "From a file of Nastran (OP4, OP2, f06, DMIG), MATLAB, CalculiX or modal data (CSV) to a "
      "body, with all checks; units (length [m], mass [kg], time [s]) of the file.");
}

}  // namespace

void bind_fe(py::module_& m) {
  py::module_ fe = m.def_submodule("fe", "Finite-element models, files, and bodies from them.");
  bind_ports_of_modes(m);
  bind_modal_data(m);
  bind_modes(fe);
  bind_beams(m);
  bind_meshes(fe);
  bind_readers(fe);
}

}  // namespace titop::python
