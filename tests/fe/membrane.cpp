#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/mistakes.hpp"

/// Membranes: patch test, waves in closed form, a rod, mass, bending beside them, mistakes.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using std::numbers::pi;
using titop_test::error_of;
using titop_test::says;

namespace {

/// An orthotropic plate that is no square in any respect.
Plate orthotropic() {
  return {.a = 1.2,
          .b = 0.7,
          .thickness = 0.01,
          .material = {.rho = 100},
          .D = PlateStiffness{1, 0.3, 2, 0.35},
          .elements = {3, 4},
          .in_plane = InPlane::membrane,
          .A = MembraneStiffness{5, 1.1, 3, 0.8}};
}

Plate sheet(double a, double b, double nu, std::array<int, 2> elements) {
  return {.a = a,
          .b = b,
          .thickness = 0.002,
          .material = {.E = 70e9, .nu = nu, .rho = 2700},
          .elements = elements,
          .in_plane = InPlane::membrane};
}

/// x and y of every node by a function of its place, 0 elsewhere.
template <class F>
VectorXd field(const fe::Mesh& mesh, F f) {
  VectorXd u = VectorXd::Zero(static_cast<Index>(mesh.dofs.size()));
  for (Index i = 0; i < u.size(); ++i) {
    const fe::Dof& dof = mesh.dofs[static_cast<std::size_t>(i)];
    if (dof.component < 2) u(i) = f(mesh.points[dof.point].position)(dof.component);
  }
  return u;
}

bool inside(const Plate& plate, const Vector3d& at) {
  return at.x() > 1e-9 && at.x() < plate.a - 1e-9 && at.y() > 1e-9 && at.y() < plate.b - 1e-9;
}

/// Lowest omegas of motions in the plane whose normal displacement is 0 at all edges.
VectorXd between_smooth_walls(const Plate& plate) {
  const fe::Mesh mesh = plate_mesh(plate);
  std::vector<Index> free;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const Vector3d& at = mesh.points[mesh.dofs[i].point].position;
    const int c = mesh.dofs[i].component;
    if (c > 1) continue;
    const double end = c == 0 ? plate.a : plate.b;
    if (at(c) > 1e-9 && at(c) < end - 1e-9) free.push_back(static_cast<Index>(i));
  }
  return eigh(mesh.K(free, free), mesh.M(free, free)).lambda.cwiseSqrt();
}

/// Between smooth walls: u = sin kx cos ly, v = cos kx sin ly, waves of compression and of shear at
/// speeds sqrt(E / (rho (1 - nu^2))) and sqrt(G / rho), k = i pi / a, l = j pi / b.
std::vector<double> waves(const Plate& plate, int count) {
  const Material& m = plate.material;
  const double nu = *m.nu, compression = std::sqrt(m.E / (m.rho * (1 - nu * nu))),
               shear = std::sqrt(m.E / (2 * (1 + nu) * m.rho));
  std::vector<double> omega;
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j <= 12; ++j) {
      if (i + j == 0) continue;
      const double k = std::hypot(i * pi / plate.a, j * pi / plate.b);
      omega.push_back(compression * k);
      if (i > 0 && j > 0) omega.push_back(shear * k);
    }
  std::ranges::sort(omega);
  omega.resize(static_cast<std::size_t>(count));
  return omega;
}

/// omega^2 over that of the rod, of a wave along linear elements with their consistent mass:
/// 6 (1 - cos kh) / (2 + cos kh) / (kh)^2.
double of_linear_elements(double kh) {
  return 6 * (1 - std::cos(kh)) / ((2 + std::cos(kh)) * kh * kh);
}

}  // namespace

TEST_CASE("patch test: constant strains have their energy, and no force on a node inside") {
  const Plate plate = orthotropic();
  const fe::Mesh mesh = plate_mesh(plate);
  const auto [A11, A12, A22, A66] = *plate.A;
  for (const Vector3d& strain :
       {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), Vector3d(0.3, -0.8, 0.5)}) {
    const double ex = strain(0), ey = strain(1), g = strain(2), turn = 0.7;
    const VectorXd u = field(mesh, [&](const Vector3d& r) {
      return Eigen::Vector2d(2 + ex * r.x() + (g / 2 - turn) * r.y(),
                             (g / 2 + turn) * r.x() + ey * r.y() - 1);
    });
    const double energy =
        plate.a * plate.b / 2 * (A11 * ex * ex + 2 * A12 * ex * ey + A22 * ey * ey + A66 * g * g);
    CHECK(relative(0.5 * u.dot(mesh.K * u), energy) <= 1e-12);
    const VectorXd force = mesh.K * u;
    for (Index i = 0; i < u.size(); ++i) {
      const fe::Dof& dof = mesh.dofs[static_cast<std::size_t>(i)];
      if (inside(plate, mesh.points[dof.point].position))
        CHECK(std::abs(force(i)) <= 1e-12 * force.cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE("waves between smooth walls in closed form, from above, error falling with h^2") {
  const int count = 6;  // later ones change places in coarse meshes
  Plate plate = sheet(1.5, 1, 0.3, {12, 8});
  const std::vector<double> exact = waves(plate, count);
  const VectorXd coarse = between_smooth_walls(plate);
  plate.elements = {24, 16};
  const VectorXd fine = between_smooth_walls(plate);
  for (int i = 0; i < count; ++i) {
    const double omega = exact[static_cast<std::size_t>(i)];
    INFO("wave ", i + 1, ": ", coarse(i), " ", fine(i), ", exact ", omega);
    const double off = coarse(i) / omega - 1, less = fine(i) / omega - 1;
    CHECK(less > 0);
    CHECK(less <= 0.01);
    CHECK(off / less >= 3.5);
    CHECK(off / less <= 4.5);
  }
}

TEST_CASE("a strip held at its end: the rod's frequencies, those of bending, and its mass") {
  const Plate plate = sheet(2, 0.25, 0, {10, 2});
  const auto data_of = [](const Plate& p) {
    fe::Mesh mesh = plate_mesh(p);
    mesh = fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
    mesh = fe::with_interface(mesh, "tip", fe::average(fe::edge(mesh, "x1")));
    return fe::modal_data(mesh, "root", {"tip"});
  };
  const ModalData membrane = data_of(plate);
  Plate stiff = plate;
  stiff.in_plane = InPlane::rigid;
  const ModalData rigid = data_of(stiff);
  const auto nearest = [&](double omega) {
    return (membrane.omega.array() / omega - 1).abs().minCoeff();
  };
  const double speed = std::sqrt(plate.material.E / plate.material.rho), h = plate.a / 10;
  for (int i = 1; i <= 4; ++i) {
    const double k = (i - 0.5) * pi / plate.a;
    CHECK(nearest(speed * k * std::sqrt(of_linear_elements(k * h))) <= 1e-9);
  }
  for (Index i = 0; i < 8; ++i) CHECK(nearest(rigid.omega(i)) <= 1e-9);
  CHECK(membrane.omega.size() == rigid.omega.size() + 2 * 30);
  CHECK((membrane.D_P - rigid.D_P).cwiseAbs().maxCoeff() <= 1e-12 * rigid.D_P.maxCoeff());
  // Static: F a / (E h b) along the strip.
  const MatrixXd& Phi = membrane.children.at(0).Phi_C;
  const double soft =
      Phi.row(0).cwiseQuotient(membrane.omega.cwiseAbs2().transpose()).dot(Phi.row(0));
  CHECK(relative(soft, plate.a / (plate.material.E * plate.thickness * plate.b)) <= 1e-9);
}

TEST_CASE("membranes that cannot be, and single nodes of them, are refused") {
  Plate plate = orthotropic();
  plate.A.reset();
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"D and no A", "A11"}));
  plate = orthotropic();
  plate.in_plane = InPlane::rigid;
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"A", "InPlane::membrane"}));
  plate = orthotropic();
  plate.A->A12 = 4;
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"A12 4", "A11 5"}));
  plate = sheet(1, 1, 0.3, {2, 2});
  plate.A = MembraneStiffness{1, 0.3, 1, 0.35};
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"A and no D"}));
  plate = sheet(1, 1, 0.3, {52, 52});
  CHECK(says(error_of([&] { check(plate); }), Code::bad_value, {"52 x 52", "16854"}));
  fe::Mesh mesh = plate_mesh(sheet(1, 1, 0.3, {2, 2}));
  CHECK(says(error_of([&] { fe::modal_data(mesh, "0,1", {}); }), Code::bad_modes,
             {"0,1", "rz", "fe::rigid", "fe::average"}));
  mesh = fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
  CHECK(says(error_of([&] { fe::modal_data(mesh, "root", {"2,2"}); }), Code::bad_modes,
             {"2,2", "rz", "fe::rigid"}));
}
