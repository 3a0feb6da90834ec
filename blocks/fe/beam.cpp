#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/hermite.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <utility>
#include <vector>

namespace titop {

using Eigen::Index;

namespace {

using std::numbers::pi;

void require_positive(double value, const char* subject) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error(Code::bad_value, fmt::format("{} is {}, not a positive number", subject, value),
                "give it in metres");
}

double polar_moment(const Section& s) { return s.I_x ? *s.I_x : s.I_y + s.I_z; }

/// Places a bar of two nodes, one component each.
void add_bar(fe::Mesh& mesh, Index first, int component, double stiffness, double mass) {
  const Index i = first + component, j = i + 6;
  mesh.K(i, i) += stiffness;
  mesh.K(j, j) += stiffness;
  mesh.K(i, j) -= stiffness;
  mesh.K(j, i) -= stiffness;
  mesh.M(i, i) += mass / 3;
  mesh.M(j, j) += mass / 3;
  mesh.M(i, j) += mass / 6;
  mesh.M(j, i) += mass / 6;
}

/// Places a bending element of length h: deflection w and slope component. `sign` is +1 if the
/// rotation is +dw/dx (about z, deflection y), -1 if it is -dw/dx (about y, deflection z).
void add_bending(fe::Mesh& mesh, Index first, int deflection, int rotation, double sign, double EI,
                 double mass, double h) {
  const double k = EI / (h * h * h), m = mass / 420, a = sign * h;
  const std::vector<Index> rows = {first + deflection, first + rotation, first + 6 + deflection,
                                   first + 6 + rotation};
  mesh.K(rows, rows) += k * fe::hermite_bending(a);
  mesh.M(rows, rows) += m * fe::hermite_mass(a);
}

}  // namespace

Section rectangle(double width_y, double height_z) {
  require_positive(width_y, "width of a rectangle");
  require_positive(height_z, "height of a rectangle");
  const double a = std::max(width_y, height_z), b = std::min(width_y, height_z);
  double sum = 0;
  // The tail after n is 1 / (8 n^4), 2e-16 here; small terms first, for their digits.
  for (int n = 4999; n > 0; n -= 2) sum += std::tanh(n * pi * a / (2 * b)) / std::pow(n, 5);
  const double J = a * b * b * b / 3 * (1 - 192 / std::pow(pi, 5) * b / a * sum);
  return {.area = width_y * height_z,
          .I_y = width_y * std::pow(height_z, 3) / 12,
          .I_z = height_z * std::pow(width_y, 3) / 12,
          .J = J};
}

Section circle(double diameter) { return tube(diameter, 0); }

Section tube(double outer_diameter, double inner_diameter) {
  require_positive(outer_diameter, "outer diameter of a tube");
  if (!(inner_diameter >= 0 && inner_diameter < outer_diameter))
    throw Error(Code::bad_value,
                fmt::format("inner diameter of a tube is {}, not between 0 and "
                            "the outer one, {}",
                            inner_diameter, outer_diameter),
                "the order is tube(outer, inner), in metres");
  // Differences of powers as products, which keep the digits of a thin wall.
  const double D = outer_diameter, d = inner_diameter;
  const double area = pi / 4 * (D - d) * (D + d);
  const double I = area / 16 * (D * D + d * d);
  return {.area = area, .I_y = I, .I_z = I, .J = 2 * I};
}

void check(const Beam& beam) {
  std::vector<Mistake> mistakes;
  const auto positive = [&](double value, const char* subject) {
    if (!(value > 0) || !std::isfinite(value))
      mistakes.push_back(
          {Code::bad_value,
           fmt::format("{} of the beam is {}, not a positive number", subject, value),
           {},
           "Beam must give it, in SI units"});
  };
  positive(beam.length, "length");
  positive(beam.section.area, "section.area");
  positive(beam.section.I_y, "section.I_y");
  positive(beam.section.I_z, "section.I_z");
  positive(beam.section.J, "section.J");
  positive(polar_moment(beam.section), "section.I_x");
  positive(beam.elements, "elements");
  add_mistakes(beam.material, "beam", mistakes);
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

fe::Mesh beam_mesh(const Beam& beam) {
  check(beam);
  const auto nodes = static_cast<std::size_t>(beam.elements) + 1;
  const double h = beam.length / beam.elements, rho = beam.material.rho;
  const double EA = beam.material.E * beam.section.area;
  const double GJ = shear_modulus(beam.material) * beam.section.J;
  const double mass = rho * beam.section.area * h;
  fe::Mesh mesh;
  mesh.name = "beam";
  mesh.warnings = implausible(beam);
  for (std::size_t i = 0; i < nodes; ++i) {
    const double x = beam.length * static_cast<double>(i) / beam.elements;
    mesh.points.push_back({std::to_string(i), Vector3d(x, 0, 0)});
    for (int component = 0; component < 6; ++component) mesh.dofs.push_back({i, component});
  }
  mesh.interfaces = {{"P", 0}, {"C", nodes - 1}};
  mesh.M = Eigen::MatrixXd::Zero(static_cast<Index>(6 * nodes), static_cast<Index>(6 * nodes));
  mesh.K = mesh.M;
  for (int e = 0; e < beam.elements; ++e) {
    const Index first = 6 * Index{e};
    add_bar(mesh, first, 0, EA / h, mass);
    add_bar(mesh, first, 3, GJ / h, rho * polar_moment(beam.section) * h);
    add_bending(mesh, first, 1, 5, 1, beam.material.E * beam.section.I_z, mass, h);
    add_bending(mesh, first, 2, 4, -1, beam.material.E * beam.section.I_y, mass, h);
  }
  return mesh;
}

std::vector<std::string> implausible(const Beam& beam) {
  return implausible_modulus(beam.material.E);
}

ModalData modal_data(const Beam& beam) {
  return fe::modal_data(beam_mesh(beam), "P", {"C"}, beam.modes);
}

}  // namespace titop
