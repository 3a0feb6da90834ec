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
using Eigen::Matrix2d;
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

MembraneStiffness membrane_of(const Plate& plate) {
  if (plate.A) return *plate.A;
  const double nu = poisson_ratio(plate.material);
  const double A = plate.material.E * plate.thickness / ((1 - nu) * (1 + nu));
  return {A, nu * A, A, (1 - nu) * A / 2};
}

/// A(i, i') B(j, j') for functions f_i(x) g_j(y) of the nodes (0,0), (0,1), (1,0), (1,1).
Matrix4d of_nodes(const Matrix2d& A, const Matrix2d& B) {
  Matrix4d result;
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 2; ++j) result.block<2, 2>(2 * i, 2 * j) = A(i, j) * B;
  return result;
}

/// Integrals over an element of length h of its two linear functions; rows and columns are
/// functions.
struct LinearIntegrals {
  Matrix2d values;  ///< of f f
  Matrix2d slopes;  ///< of f' f'
  Matrix2d mixed;   ///< of f' (row) f (column)
};
LinearIntegrals linear_integrals(double h) {
  LinearIntegrals of;
  of.values << h / 3, h / 6, h / 6, h / 3;
  of.slopes << 1 / h, -1 / h, -1 / h, 1 / h;
  of.mixed << -0.5, -0.5, 0.5, 0.5;
  return of;
}

/// M and K of one element of a membrane: the four x, then the four y.
struct MembraneElement {
  Eigen::Matrix<double, 8, 8> M, K;
};
MembraneElement membrane_element(const Plate& plate, double hx, double hy) {
  const LinearIntegrals x = linear_integrals(hx), y = linear_integrals(hy);
  const auto [A11, A12, A22, A66] = membrane_of(plate);
  const Matrix4d mass = plate.material.rho * plate.thickness * of_nodes(x.values, y.values);
  const Matrix4d xx = of_nodes(x.slopes, y.values), yy = of_nodes(x.values, y.slopes),
                 xy = A12 * of_nodes(x.mixed, y.mixed.transpose()) +
                      A66 * of_nodes(x.mixed.transpose(), y.mixed);
  MembraneElement e;
  e.M << mass, Matrix4d::Zero(), Matrix4d::Zero(), mass;
  e.K << A11 * xx + A66 * yy, xy, xy.transpose(), A22 * yy + A66 * xx;
  return e;
}

bool positive_definite(double d11, double d12, double d22, double d66) {
  return d11 > 0 && d22 > 0 && d66 > 0 && d12 * d12 < d11 * d22 && std::isfinite(d11 + d22 + d66);
}

void add_membrane_mistakes(const Plate& plate, std::vector<Mistake>& mistakes) {
  const auto add = [&](std::string message, std::string hint) {
    mistakes.push_back({Code::bad_value, std::move(message), {}, std::move(hint)});
  };
  const bool membrane = plate.in_plane == InPlane::membrane;
  if (plate.A && !membrane)
    return add("the plate has A and is rigid in its plane",
               "add .in_plane = InPlane::membrane, or leave A out");
  if (membrane && plate.D && !plate.A)
    add("the plate is a membrane of unknown stiffness: it has D and no A",
        "give Plate::A = {A11, A12, A22, A66}, in N/m; of a sandwich twice that of a skin");
  if (plate.A && !plate.D)
    add("the plate has A and no D", "give both, or E and nu in place of both");
  if (!plate.A) return;
  const auto [A11, A12, A22, A66] = *plate.A;
  if (!positive_definite(A11, A12, A22, A66))
    add(fmt::format("A of the plate is not positive definite: A11 {}, A12 {}, A22 {}, A66 {}", A11,
                    A12, A22, A66),
        "A11, A22, A66 are positive and A12^2 is below A11 A22, in N/m");
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
  if (!positive_definite(D11, D12, D22, D66))
    add(fmt::format("D of the plate is not positive definite: D11 {}, D12 {}, D22 {}, D66 {}", D11,
                    D12, D22, D66),
        "D11, D22, D66 are positive and D12^2 is below D11 D22, in N m");
}

/// Degrees of freedom of a node.
int dofs_of(const Plate& plate) { return plate.in_plane == InPlane::membrane ? 6 : 4; }

constexpr double kMostBytes = 2.2e9;  ///< of M and of K; their modes take some days

void add_size_mistake(const Plate& plate, std::vector<Mistake>& mistakes) {
  const auto [nx, ny] = plate.elements;
  const double rows = dofs_of(plate) * (double(nx) + 1) * (double(ny) + 1), bytes = 8 * rows * rows;
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
      if (plate.in_plane == InPlane::membrane)
        for (const int component : {0, 1}) mesh.dofs.push_back({point, component});
      if (i == 0) edges[0].points.push_back(point);
      if (i == nx) edges[1].points.push_back(point);
      if (j == 0) edges[2].points.push_back(point);
      if (j == ny) edges[3].points.push_back(point);
    }
  mesh.edges.assign(edges.begin(), edges.end());
}

/// Adds M and K of one element to those of the mesh; `rows_of`: its rows, from the first row of
/// each of its nodes.
template <class Rows>
void add_elements(const Plate& plate, fe::Mesh& mesh, const MatrixXd& M, const MatrixXd& K,
                  Rows rows_of) {
  const auto [nx, ny] = plate.elements;
  const Index width = dofs_of(plate);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const Index first = width * (Index{i} * (ny + 1) + j),
                  second = first + width * (Index{ny} + 1);
      const std::vector<Index> rows =
          rows_of(std::array{first, first + width, second, second + width});
      mesh.M(rows, rows) += M;
      mesh.K(rows, rows) += K;
    }
}

void add_bending(const Plate& plate, fe::Mesh& mesh) {
  const auto [D11, D12, D22, D66] = stiffness_of(plate);
  const fe::HermiteIntegrals x = fe::hermite_integrals(plate.a / plate.elements[0]);
  const fe::HermiteIntegrals y = fe::hermite_integrals(plate.b / plate.elements[1]);
  const Matrix16 M = plate.material.rho * plate.thickness * product(x.values, y.values);
  const Matrix16 K =
      D11 * product(x.curvatures, y.values) + D22 * product(x.values, y.curvatures) +
      D12 * (product(x.mixed, y.mixed.transpose()) + product(x.mixed.transpose(), y.mixed)) +
      4 * D66 * product(x.slopes, y.slopes);
  add_elements(plate, mesh, M, K, [](const std::array<Index, 4>& nodes) {
    std::vector<Index> rows;
    for (const Index node : nodes)
      for (Index dof = 0; dof < 4; ++dof) rows.push_back(node + dof);
    return rows;
  });
}

void add_membrane(const Plate& plate, fe::Mesh& mesh) {
  const auto [M, K] =
      membrane_element(plate, plate.a / plate.elements[0], plate.b / plate.elements[1]);
  add_elements(plate, mesh, M, K, [](const std::array<Index, 4>& nodes) {
    std::vector<Index> rows;
    for (Index dof = 4; dof < 6; ++dof)
      for (const Index node : nodes) rows.push_back(node + dof);
    return rows;
  });
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
  add_membrane_mistakes(plate, mistakes);
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
  fe::Mesh mesh;
  mesh.name = "plate";
  mesh.warnings = implausible(plate);
  add_points(plate, mesh);
  const auto n = static_cast<Index>(mesh.dofs.size());
  mesh.M = MatrixXd::Zero(n, n);
  mesh.K = mesh.M;
  add_bending(plate, mesh);
  if (plate.in_plane == InPlane::membrane)
    add_membrane(plate, mesh);
  else
    mesh.rigid = mass_of(plate);
  return mesh;
}

}  // namespace titop
