#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/mistakes.hpp"

/// Plate: frequencies against closed forms and published ones, energies, mass, mistakes.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using std::numbers::pi;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Frequencies of this plate are omega a^2 sqrt(rho h / D): D = 1, rho h = 1, nu = 0.3.
Plate unit_plate(int elements, double a = 1, double b = 1) {
  return {.a = a,
          .b = b,
          .thickness = 0.01,
          .material = {.rho = 100},
          .D = PlateStiffness{1, 0.3, 1, 0.35},
          .elements = {elements, elements}};
}

/// True for a degree of freedom, (component, x, y), that is held.
using Held = std::function<bool(int, double, double)>;

/// The lowest omegas of the mesh with rows held.
VectorXd omegas(const fe::Mesh& mesh, const Held& held) {
  std::vector<Index> free;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const Vector3d& at = mesh.points[mesh.dofs[i].point].position;
    if (!held(mesh.dofs[i].component, at.x(), at.y())) free.push_back(static_cast<Index>(i));
  }
  const VectorXd lambda = eigh(mesh.K(free, free), mesh.M(free, free)).lambda;
  return lambda.cwiseMax(0).cwiseSqrt();
}

bool clamped_at_x0(int, double x, double) { return x == 0; }
bool free_plate(int, double, double) { return false; }
bool clamped(int, double x, double y) { return x == 0 || x == 1 || y == 0 || y == 1; }

/// Simply supported at x = 0 and x = a: w and its slope along the edge, ry kept free.
Held supported(double a, double b, bool at_y) {
  return [=](int component, double x, double y) {
    const bool on_x = x == 0 || std::abs(x - a) < 1e-12, on_y = y == 0 || std::abs(y - b) < 1e-12;
    if (on_x && (component == 2 || component == 3)) return true;
    return at_y && on_y && (component == 2 || component == 4);
  };
}

/// First term of the relative error of a beam's omega with these functions (dispersion relation of
/// the element), of k half waves along 8 elements; a plate's is less, by that of its longer waves.
double error_of_waves(int k) { return std::pow(k * pi / 8, 4) / 1440; }

void check_omegas(const VectorXd& omega, Index first, const std::vector<double>& expected,
                  double tolerance) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    INFO("mode ", i + 1, ": ", omega(first + static_cast<Index>(i)), ", expected ", expected[i]);
    CHECK(relative(omega(first + static_cast<Index>(i)), expected[i]) <= tolerance);
  }
}

}  // namespace

TEST_CASE("simply supported square: pi^2 (i^2 + j^2), from above, error falling with h^4") {
  const std::vector<double> exact = {2 * pi * pi, 5 * pi * pi, 5 * pi * pi, 8 * pi * pi};
  std::vector<VectorXd> found;
  for (const int elements : {4, 8})
    found.push_back(omegas(plate_mesh(unit_plate(elements)), supported(1, 1, true)));
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const double coarse = found[0](static_cast<Index>(k)) / exact[k] - 1;
    const double fine = found[1](static_cast<Index>(k)) / exact[k] - 1;
    INFO("mode ", k + 1, ": ", coarse, " ", fine);
    CHECK(fine > 0);
    CHECK(fine <= error_of_waves(k == 0 ? 1 : 2));
    CHECK(std::abs(std::log2(coarse / fine) - 4) <= 0.2);
  }
}

TEST_CASE("simply supported orthotropic rectangle against its closed form") {
  // omega^2 rho h = D11 p^4 + 2 (D12 + 2 D66) p^2 q^2 + D22 q^4, p = i pi / a, q = j pi / b.
  const PlateStiffness D{100, 20, 30, 25};
  const Plate plate{
      .a = 1.5, .b = 0.8, .thickness = 0.02, .material = {.rho = 500}, .D = D, .elements = {8, 8}};
  const VectorXd omega = omegas(plate_mesh(plate), supported(1.5, 0.8, true));
  struct Mode {
    double omega, error;
  };
  std::vector<Mode> exact;
  for (int i = 1; i <= 3; ++i)
    for (int j = 1; j <= 3; ++j) {
      const double p = i * pi / 1.5, q = j * pi / 0.8;
      exact.push_back({std::sqrt((D.D11 * std::pow(p, 4) + 2 * (D.D12 + 2 * D.D66) * p * p * q * q +
                                  D.D22 * std::pow(q, 4)) /
                                 10),
                       error_of_waves(std::max(i, j))});
    }
  std::sort(exact.begin(), exact.end(),
            [](const Mode& a, const Mode& b) { return a.omega < b.omega; });
  for (Index k = 0; k < 4; ++k) {
    const Mode& mode = exact[static_cast<std::size_t>(k)];
    CHECK(omega(k) > mode.omega);
    CHECK(relative(omega(k), mode.omega) <= mode.error);
  }
}

TEST_CASE("clamped, free and supported plates: published frequencies, and this mesh elsewhere") {
  // Barton 1951 (up to 0.7 % high; code_aster SDLS01), Leissa 1973.
  const VectorXd cantilever = omegas(plate_mesh(unit_plate(8)), clamped_at_x0);
  check_omegas(cantilever, 0, {3.492, 8.525, 21.43, 27.33, 31.11, 54.44}, 0.011);
  const VectorXd free = omegas(plate_mesh(unit_plate(8)), free_plate),
                 all_round = omegas(plate_mesh(unit_plate(8)), clamped),
                 two_sides = omegas(plate_mesh(unit_plate(8)), supported(1, 1, false)),
                 long_one = omegas(plate_mesh(unit_plate(8, 2, 1)), clamped_at_x0);
  check_omegas(free, 3, {13.49, 19.79, 24.43, 35.02, 35.02}, 0.011);
  check_omegas(all_round, 0, {35.99, 73.41, 73.41, 108.27}, 2e-3);
  check_omegas(two_sides, 0, {9.631, 16.135, 36.726, 38.945, 46.738, 70.740}, 1e-3);
  check_omegas(long_one, 0, {3.440 / 4, 14.805 / 4, 21.438 / 4, 48.19 / 4}, 2e-3);
  // The same elements in another program, 8 x 8.
  check_omegas(cantilever, 0,
               {3.472008941, 8.509565508, 21.292492263, 27.203690400, 30.969963637, 54.218273763},
               1e-8);
  check_omegas(free, 3,
               {13.468852819, 19.597432287, 24.272800466, 34.807549633, 34.807549633, 61.130558339},
               1e-8);
  check_omegas(omegas(plate_mesh(unit_plate(8)), supported(1, 1, true)), 0,
               {19.739372260, 49.356313710, 49.356313710, 78.967371753, 98.799596604}, 1e-8);
  check_omegas(
      all_round, 0,
      {35.990832665, 73.438771603, 73.438771603, 108.308512984, 131.873854626, 132.491849148},
      1e-8);
  check_omegas(two_sides, 0,
               {9.631565956, 16.135180710, 36.730344720, 38.955823176, 46.749395967, 70.760963183},
               1e-8);
  check_omegas(long_one, 0, {3.441305190 / 4, 14.808197562 / 4, 21.444436065 / 4, 48.203981808 / 4},
               1e-8);
}

TEST_CASE("NAFEMS FV12 and FV16: a square of 10 m, free and cantilevered, in Hz") {
  const Plate plate{.a = 10,
                    .b = 10,
                    .thickness = 0.05,
                    .material = {.E = 200e9, .nu = 0.3, .rho = 8000},
                    .elements = {8, 8}};
  const fe::Mesh mesh = plate_mesh(plate);
  check_omegas(omegas(mesh, free_plate) / (2 * pi), 3, {1.622, 2.360, 2.922, 4.233, 4.233, 7.416},
               0.011);
  check_omegas(omegas(mesh, clamped_at_x0) / (2 * pi), 0,
               {0.421, 1.029, 2.582, 3.306, 3.753, 6.555}, 0.011);
}

TEST_CASE("energy of constant curvatures: each entry of D") {
  const PlateStiffness D{7, 2, 5, 3};
  const Plate plate{
      .a = 1.5, .b = 0.8, .thickness = 0.02, .material = {.rho = 500}, .D = D, .elements = {3, 2}};
  const fe::Mesh mesh = plate_mesh(plate);
  const double area = 1.5 * 0.8;
  // w = (xx x^2 + yy y^2) / 2 + xy x y, with w_x = -ry, w_y = rx.
  const auto energy = [&](double xx, double yy, double xy) {
    VectorXd u(mesh.K.rows());
    for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
      const Vector3d& at = mesh.points[mesh.dofs[i].point].position;
      const double x = at.x(), y = at.y();
      double value = xy;
      if (mesh.dofs[i].component == 2) value = (xx * x * x + yy * y * y) / 2 + xy * x * y;
      if (mesh.dofs[i].component == 3) value = yy * y + xy * x;
      if (mesh.dofs[i].component == 4) value = -(xx * x + xy * y);
      u(static_cast<Index>(i)) = value;
    }
    return u.dot(mesh.K * u);
  };
  CHECK(relative(energy(1, 0, 0), D.D11 * area) <= 1e-12);
  CHECK(relative(energy(0, 1, 0), D.D22 * area) <= 1e-12);
  CHECK(relative(energy(1, 1, 0), (D.D11 + 2 * D.D12 + D.D22) * area) <= 1e-12);
  CHECK(relative(energy(0, 0, 1), 4 * D.D66 * area) <= 1e-12);
}

TEST_CASE("mass, rigid motions, and rigid in its plane") {
  const Plate plate{.a = 1.5,
                    .b = 0.8,
                    .thickness = 0.02,
                    .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                    .elements = {3, 2}};
  const fe::Mesh mesh = plate_mesh(plate);
  const double m = 2700 * 0.02 * 1.5 * 0.8;
  const Vector3d inertia = m / 12 * Vector3d(0.64, 2.25, 2.89), centre(0.75, 0.4, 0);
  const MatrixXd R = fe::rigid_motions(mesh, Vector3d::Zero());
  const Matrix6 D_O = rigid_mass(m, inertia.asDiagonal(), -centre);
  Matrix6 moving = R.transpose() * mesh.M * R;
  for (const Index i : {2, 3, 4})
    for (const Index j : {2, 3, 4}) CHECK(std::abs(moving(i, j) - D_O(i, j)) <= 1e-13 * m);
  CHECK(fe::mesh_report(mesh).KR_terms <= 1e-14);
  const ModalData data = fe::modal_data(mesh, "1,2", {"3,0", "0,1"});
  const Vector3d P(0.5, 0.8, 0);
  CHECK((data.D_P - rigid_mass(m, inertia.asDiagonal(), P - centre)).cwiseAbs().maxCoeff() <=
        1e-12 * m);
  CHECK((data.children[0].PC - (Vector3d(1.5, 0, 0) - P)).norm() <= 1e-15);
  for (const Index still : {0, 1, 5}) {
    CHECK(data.L_P.col(still).isZero(0));
    CHECK(data.children[1].Phi_C.row(still).isZero(0));
  }
  CHECK(data.omega.size() == 4 * 12 - 3);
  CHECK(mesh.points[5].name == "1,2");
  REQUIRE(mesh.edges.size() == 4);
  CHECK(mesh.edges[1].name == "x1");
  CHECK(mesh.points[mesh.edges[1].points[2]].name == "3,2");
  CHECK(mesh.points[mesh.edges[2].points[3]].name == "3,0");
  CHECK(fe::dof_name(mesh, 7) == "0,1.wxy");
}

TEST_CASE("held at one node, a plate's frequencies fall with every mesh") {
  // The same elements in another program: 4 x 4 and 8 x 8 with 4 decimals, 16 x 16 with 6.
  const auto first = [](int elements, const std::string& node) {
    return fe::modal_data(plate_mesh(unit_plate(elements)), node, {}, {.kept = 3}).omega;
  };
  check_omegas(first(4, "2,2"), 0, {7.8897, 7.8897}, 1e-5);
  check_omegas(first(8, "4,4"), 0, {6.9612, 6.9612}, 1e-5);
  check_omegas(first(16, "8,8"), 0, {6.297479, 6.297479}, 1e-6);
  check_omegas(first(4, "0,2"), 0, {2.2162, 3.4535}, 3e-5);
  check_omegas(first(8, "0,4"), 0, {1.9509, 3.1700}, 3e-5);
  check_omegas(first(16, "0,8"), 0, {1.756809, 2.945442}, 1e-6);
}

TEST_CASE("plates that cannot be are refused, all mistakes at once") {
  const Error all = error_of([] { plate_mesh(Plate{.elements = {0, 4}}); });
  for (const char* subject :
       {"a of", "b of", "thickness", "elements[0]", "material.E", "material.rho"})
    CHECK(says(all, Code::bad_value, {subject, "0"}));
  CHECK(says(all, Code::bad_value, {"neither", "nu", "G"}));
  Plate plate = unit_plate(2);
  plate.D->D12 = -1.2;
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"D12 -1.2", "D11 1"}));
  plate = unit_plate(2);
  plate.material.E = 70e9;
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"both", "D", "E"}));
  // 161604 rows: M alone would take 209 GB.
  plate = unit_plate(200);
  CHECK(says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"200 x 200", "161604"}));
  CHECK(error_of([] { check(unit_plate(63)); }).mistakes().empty());
  // A sandwich: E / (2 G) - 1 is no Poisson's ratio.
  plate = {.a = 1, .b = 1, .thickness = 0.02, .material = {.E = 70e9, .G = 20e9, .rho = 300}};
  CHECK(
      says(error_of([&] { plate_mesh(plate); }), Code::bad_value, {"0.75", "D11, D12, D22, D66"}));
  plate.material.G = 70e9 / 2.6;  // nu = 0.3
  const fe::Mesh by_G = plate_mesh(plate);
  plate.material.G.reset(), plate.material.nu = 0.3;
  CHECK((by_G.K - plate_mesh(plate).K).cwiseAbs().maxCoeff() <= 1e-14 * by_G.K.maxCoeff());
}

TEST_CASE("legal plates that are probably mistakes") {
  Plate plate{.a = 1, .b = 0.5, .thickness = 0.02, .material = {.E = 70e9, .nu = 0.3, .rho = 2700}};
  CHECK(implausible(plate).empty());
  plate.thickness = 0.06, plate.material.E = 70e3;
  const std::vector<std::string> lines = implausible(plate);
  REQUIRE(lines.size() == 2);
  CHECK(titop_test::has_names(lines[0], {"7e+04"}));
  CHECK(titop_test::has_names(lines[1], {"thickness", "0.06", "0.5"}));
  // They reach the body's log.
  plate.elements = {1, 1};
  const fe::Mesh mesh = plate_mesh(plate);
  CHECK(mesh.warnings == lines);
  const fe::Mesh held = fe::with_interface(mesh, "P", fe::rigid(fe::edge(mesh, "x0")));
  CHECK(fe::modal_data(held, "P", {}).warnings == lines);
}
