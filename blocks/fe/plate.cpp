#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/fe/hermite.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/error.hpp>
#include <utility>

namespace titop {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::MatrixXd;

namespace {

using Matrix16 = Eigen::Matrix<double, 16, 16>;

PlateStiffness stiffness_of(const Plate& plate) {
  if (plate.D) return *plate.D;
  const double nu = poisson_ratio(plate.material);
  const double D = plate.material.E * std::pow(plate.thickness, 3) / (12 * (1 - nu) * (1 + nu));
  return {D, nu * D, D, (1 - nu) * D / 2};
}

/// A degree of freedom of a node: the function of x and that of y of which it is the product, 0 by
/// value and 1 by slope, and its sign.
struct PlateDof {
  int component, x, y;
  double sign;
};
constexpr std::array<PlateDof, 4> kPlateDofs = {
    {{2, 0, 0, 1}, {3, 0, 1, 1}, {4, 1, 0, -1}, {fe::kTwist, 1, 1, 1}}};

/// sign A(x, x') B(y, y') for the 4 degrees of freedom of the nodes (0,0), (0,1), (1,0), (1,1).
Matrix16 product(const Matrix4d& A, const Matrix4d& B) {
  std::array<std::pair<int, int>, 16> at{};  // of row i: functions of x and y
  std::array<double, 16> sign{};
  for (std::size_t i = 0; i < 16; ++i) {
    const PlateDof& dof = kPlateDofs.at(i % 4);
    const int node_x = i / 8 == 0 ? 0 : 2, node_y = i / 4 % 2 == 0 ? 0 : 2;
    at.at(i) = {node_x + dof.x, node_y + dof.y};
    sign.at(i) = dof.sign;
  }
  Matrix16 result;
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t j = 0; j < 16; ++j)
      result(static_cast<Index>(i), static_cast<Index>(j)) = sign.at(i) * sign.at(j) *
                                                             A(at.at(i).first, at.at(j).first) *
                                                             B(at.at(i).second, at.at(j).second);
  return result;
}

void add_stiffness_mistakes(const Plate& plate, std::vector<Mistake>& mistakes) {
  const auto add = [&](std::string message, std::string hint) {
    mistakes.push_back({Code::bad_value, std::move(message), {}, std::move(hint)});
  };
  const Material& m = plate.material;
  if (!plate.D) {
    add_mistakes(m, "plate", mistakes);
    if (m.nu || !m.G) return;
    const double nu = poisson_ratio(m);
    if (nu > -1 && nu <= 0.5) return;
    return add(fmt::format("E / (2 G) - 1 of the plate is {}, no Poisson's ratio of an isotropic "
                           "material, above -1 and up to 0.5",
                           nu),
               "of a sandwich or laminate give Plate::D = {D11, D12, D22, D66}");
  }
  if (m.E != 0 || m.nu || m.G)
    add("the plate has both D and a material's E, nu or G", "leave the material only its rho");
  if (!(m.rho > 0) || !std::isfinite(m.rho))
    add(fmt::format("material.rho of the plate is {}, not a positive number", m.rho),
        "mass per area divided by the thickness, in kg/m^3");
  const auto [D11, D12, D22, D66] = *plate.D;
  if (!(D11 > 0 && D22 > 0 && D66 > 0 && D12 * D12 < D11 * D22) || !std::isfinite(D11 + D22 + D66))
    add(fmt::format("D of the plate is not positive definite: D11 {}, D12 {}, D22 {}, D66 {}", D11,
                    D12, D22, D66),
        "D11, D22, D66 are positive and D12^2 is below D11 D22, in N m");
}

constexpr double kMostBytes = 2.2e9;  ///< of M and of K; their modes take some days

void add_size_mistake(const Plate& plate, std::vector<Mistake>& mistakes) {
  const auto [nx, ny] = plate.elements;
  const double rows = 4 * (double(nx) + 1) * (double(ny) + 1), bytes = 8 * rows * rows;
  if (nx < 1 || ny < 1 || bytes <= kMostBytes) return;
  mistakes.push_back(
      {Code::bad_value,
       fmt::format("{} x {} elements of the plate have {:.0f} rows: M and K, which are dense, "
                   "take {:.3g} bytes each, above {:.3g}",
                   nx, ny, rows, bytes, kMostBytes),
       {},
       "8 to 24 elements a side are accurate to 1e-3 (the error falls with h^4); for more take a "
       "finite-element program and import its modes"});
}

Matrix6 mass_of(const Plate& plate) {
  const double a = plate.a, b = plate.b, m = plate.material.rho * plate.thickness * a * b;
  const Matrix3d I = (m / 12 * Vector3d(b * b, a * a, a * a + b * b)).asDiagonal().toDenseMatrix();
  return rigid_mass(m, I, -Vector3d(a / 2, b / 2, 0));
}

void add_points(const Plate& plate, fe::Mesh& mesh) {
  const auto [nx, ny] = plate.elements;
  std::array<fe::MeshEdge, 4> edges = {{{"x0", {}}, {"x1", {}}, {"y0", {}}, {"y1", {}}}};
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      const std::size_t point = mesh.points.size();
      mesh.points.push_back(
          {fmt::format("{},{}", i, j), Vector3d(plate.a * i / nx, plate.b * j / ny, 0)});
      for (const PlateDof& dof : kPlateDofs) mesh.dofs.push_back({point, dof.component});
      if (i == 0) edges[0].points.push_back(point);
      if (i == nx) edges[1].points.push_back(point);
      if (j == 0) edges[2].points.push_back(point);
      if (j == ny) edges[3].points.push_back(point);
    }
  mesh.edges.assign(edges.begin(), edges.end());
}

}  // namespace

void check(const Plate& plate) {
  std::vector<Mistake> mistakes;
  const auto positive = [&](double value, const char* subject) {
    if (!(value > 0) || !std::isfinite(value))
      mistakes.push_back(
          {Code::bad_value,
           fmt::format("{} of the plate is {}, not a positive number", subject, value),
           {},
           "Plate must give it, in SI units"});
  };
  positive(plate.a, "a");
  positive(plate.b, "b");
  positive(plate.thickness, "thickness");
  positive(plate.elements[0], "elements[0]");
  positive(plate.elements[1], "elements[1]");
  add_size_mistake(plate, mistakes);
  add_stiffness_mistakes(plate, mistakes);
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

std::vector<std::string> implausible(const Plate& plate) {
  std::vector<std::string> lines;
  if (!plate.D) lines = implausible_modulus(plate.material.E);
  constexpr double kThin = 0.1;  // first omega of SSSS 3.5 % above that with shear, 19.065
  const double side = std::min(plate.a, plate.b);
  if (plate.thickness > kThin * side)
    lines.push_back(
        fmt::format("thickness {:.3g} m of a thin plate of {:.3g} m", plate.thickness, side));
  return lines;
}

fe::Mesh plate_mesh(const Plate& plate) {
  check(plate);
  const auto [nx, ny] = plate.elements;
  const auto [D11, D12, D22, D66] = stiffness_of(plate);
  const fe::HermiteIntegrals x = fe::hermite_integrals(plate.a / nx);
  const fe::HermiteIntegrals y = fe::hermite_integrals(plate.b / ny);
  const Matrix16 M = plate.material.rho * plate.thickness * product(x.values, y.values);
  const Matrix16 K =
      D11 * product(x.curvatures, y.values) + D22 * product(x.values, y.curvatures) +
      D12 * (product(x.mixed, y.mixed.transpose()) + product(x.mixed.transpose(), y.mixed)) +
      4 * D66 * product(x.slopes, y.slopes);
  fe::Mesh mesh;
  mesh.name = "plate";
  mesh.warnings = implausible(plate);
  mesh.rigid = mass_of(plate);
  add_points(plate, mesh);
  const auto n = static_cast<Index>(mesh.dofs.size());
  mesh.M = MatrixXd::Zero(n, n);
  mesh.K = mesh.M;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const Index first = 4 * (Index{i} * (ny + 1) + j), second = first + 4 * (Index{ny} + 1);
      std::vector<Index> rows;
      for (const Index node : {first, first + 4, second, second + 4})
        for (Index dof = 0; dof < 4; ++dof) rows.push_back(node + dof);
      mesh.M(rows, rows) += M;
      mesh.K(rows, rows) += K;
    }
  return mesh;
}

}  // namespace titop
