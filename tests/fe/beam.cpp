#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/mistakes.hpp"

/// Beam: frequencies against the roots of the textbook's equations, convergence, mass, sections.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using std::numbers::pi;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Root of f in [low, high] by bisection; f changes sign there.
double root(const std::function<double(double)>& f, double low, double high) {
  const bool rises = f(high) > 0;
  REQUIRE(f(low) * f(high) < 0);
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return (low + high) / 2;
}

/// beta L of the k-th bending mode, k = 1, 2, ... (without rigid ones). Divided by cosh, so that
/// the functions stay near 1.
double clamped_free(int k) {
  return root([](double x) { return std::cos(x) + 1 / std::cosh(x); }, (k - 1) * pi, k * pi);
}
double free_free(int k) {
  return root([](double x) { return std::cos(x) - 1 / std::cosh(x); }, k * pi, (k + 1) * pi);
}
double pinned_free(int k) {
  return root([](double x) { return std::sin(x) - std::cos(x) * std::tanh(x); }, k * pi,
              (k + 0.5) * pi);
}

Beam plank(int elements) {
  return {.length = 2.0,
          .section = rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = elements};
}

const double kArea = 0.06 * 0.04;
const double kIy = 0.06 * 0.04 * 0.04 * 0.04 / 12, kIz = 0.04 * 0.06 * 0.06 * 0.06 / 12;

double bending_omega(double beta_L, double I) {
  return std::pow(beta_L / 2.0, 2) * std::sqrt(70e9 * I / (2700 * kArea));
}

/// Rows of one bending plane, without those of the first point that are held.
std::vector<Index> plane(const fe::Mesh& mesh, int deflection, int rotation,
                         const std::vector<int>& held) {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const auto [point, c] = mesh.dofs[i];
    const bool is_held = point == 0 && std::find(held.begin(), held.end(), c) != held.end();
    if ((c == deflection || c == rotation) && !is_held) rows.push_back(static_cast<Index>(i));
  }
  return rows;
}

/// k-th omega after `rigid` zeros, in the plane of the deflection.
double mesh_omega(const Beam& beam, int deflection, int rotation, const std::vector<int>& held,
                  int rigid, int k) {
  const fe::Mesh mesh = beam_mesh(beam);
  const auto rows = plane(mesh, deflection, rotation, held);
  return std::sqrt(eigh(mesh.K(rows, rows), mesh.M(rows, rows)).lambda(rigid + k - 1));
}

/// First term of the relative error of omega with cubic shapes and consistent mass, from the
/// element's dispersion relation: (beta h)^4 / 1440.
double cubic_error(double beta_L, int elements) { return std::pow(beta_L / elements, 4) / 1440; }

double slope(double error_coarse, double error_fine) {
  return std::log2(error_coarse / error_fine);
}

}  // namespace

TEST_CASE("the textbook's roots") {
  CHECK(std::abs(clamped_free(1) - 1.8751040687) <= 1e-10);
  CHECK(std::abs(clamped_free(2) - 4.6940911330) <= 1e-10);
  CHECK(std::abs(free_free(1) - 4.7300407449) <= 1e-10);
  CHECK(std::abs(pinned_free(1) - 3.9266023120) <= 1e-10);
}

TEST_CASE("clamped-free beam: omega of the modal data, error falling with h^4") {
  // Bending about y is the softer one: modes 1, 2, 3, ... alternate between the planes.
  for (const int k : {1, 2}) {
    std::vector<double> errors;
    for (const int elements : {4, 8, 16}) {
      const VectorXd omega = modal_data(plank(elements)).omega;
      double error = 1;
      for (const double w : omega)
        error = std::min(error, relative(w, bending_omega(clamped_free(k), kIy)));
      errors.push_back(error);
    }
    INFO("mode ", k, ": ", errors[0], " ", errors[1], " ", errors[2]);
    CHECK(relative(errors[2], cubic_error(clamped_free(k), 16)) <= 0.02);
    CHECK(std::abs(slope(errors[0], errors[1]) - 4) <= 0.2);
    CHECK(std::abs(slope(errors[1], errors[2]) - 4) <= 0.05);
  }
}

TEST_CASE("clamped-free beam: the first modes in order, both planes") {
  const VectorXd omega = modal_data(plank(20)).omega;
  struct Mode {
    double omega, error;
  };
  std::vector<Mode> expected;
  for (const int k : {1, 2, 3})
    for (const double I : {kIy, kIz})
      expected.push_back({bending_omega(clamped_free(k), I), cubic_error(clamped_free(k), 20)});
  std::sort(expected.begin(), expected.end(),
            [](const Mode& a, const Mode& b) { return a.omega < b.omega; });
  for (Index k = 0; k < 6; ++k) {
    const Mode& mode = expected[static_cast<std::size_t>(k)];
    CHECK(relative(omega(k), mode.omega) <= 1.01 * mode.error);
  }
}

TEST_CASE("free-free and pinned-free beam, both planes, error falling with h^4") {
  struct Plane {
    int deflection, rotation;
    double I;
  };
  for (const Plane p : {Plane{1, 5, kIz}, Plane{2, 4, kIy}})
    for (const int k : {1, 3}) {
      std::vector<double> free, pinned;
      for (const int elements : {8, 16, 32}) {
        const Beam beam = plank(elements);
        free.push_back(relative(mesh_omega(beam, p.deflection, p.rotation, {}, 2, k),
                                bending_omega(free_free(k), p.I)));
        pinned.push_back(relative(mesh_omega(beam, p.deflection, p.rotation, {p.deflection}, 1, k),
                                  bending_omega(pinned_free(k), p.I)));
      }
      CHECK(relative(free[2], cubic_error(free_free(k), 32)) <= 0.03);
      CHECK(relative(pinned[2], cubic_error(pinned_free(k), 32)) <= 0.03);
      for (const auto& errors : {free, pinned}) {
        INFO("mode ", k, ": ", errors[0], " ", errors[1], " ", errors[2]);
        CHECK(std::abs(slope(errors[0], errors[1]) - 4) <= 0.25);
        CHECK(std::abs(slope(errors[1], errors[2]) - 4) <= 0.06);
      }
    }
}

TEST_CASE("axial and torsion of a clamped beam: quarter waves, error falling with h^2") {
  const double G = 70e9 / (2 * 1.33);
  const Section section = rectangle(0.06, 0.04);
  const double axial = pi / 4 * std::sqrt(70e9 / 2700);
  const double torsion = pi / 4 * std::sqrt(G * section.J / (2700 * (section.I_y + section.I_z)));
  for (const double expected : {axial, torsion}) {
    std::vector<double> errors;
    for (const int elements : {5, 10, 20}) {
      const VectorXd omega = modal_data(plank(elements)).omega;
      double error = 1;
      for (const double w : omega)
        if (w > expected) error = std::min(error, relative(w, expected));
      errors.push_back(error);
    }
    // (pi / 2)^2 h^2 / 24 is the first term of the error of a bar with consistent mass.
    CHECK(relative(errors[1], pi * pi / 4 / 100 / 24) <= 0.02);
    CHECK(std::abs(slope(errors[0], errors[1]) - 2) <= 0.05);
    CHECK(std::abs(slope(errors[1], errors[2]) - 2) <= 0.05);
  }
}

TEST_CASE("frequencies come from above") {
  const VectorXd omega = modal_data(plank(6)).omega;
  CHECK(omega(0) > bending_omega(clamped_free(1), kIy));
  CHECK(omega(1) > bending_omega(clamped_free(1), kIz));
}

TEST_CASE("tip flexibility: P L^3 / 3EI, L^2 / 2EI, L / EA, L / GJ, signs of both planes") {
  const ModalData data = modal_data(plank(3));
  const MatrixXd& Phi = data.children[0].Phi_C;
  const MatrixXd S = Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
  const double L = 2, E = 70e9, G = E / (2 * 1.33);
  Matrix6 expected = Matrix6::Zero();
  expected.diagonal() << L / (E * kArea), L * L * L / (3 * E * kIz), L * L * L / (3 * E * kIy),
      L / (G * rectangle(0.06, 0.04).J), L / (E * kIy), L / (E * kIz);
  expected(1, 5) = expected(5, 1) = L * L / (2 * E * kIz);
  expected(2, 4) = expected(4, 2) = -L * L / (2 * E * kIy);  // a force up turns the tip about -y
  const Vector6 scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  CHECK((scale.asDiagonal() * (S - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff() <= 1e-11);
}

TEST_CASE("mass and inertia of the mesh") {
  const fe::Mesh mesh = beam_mesh(plank(5));
  const fe::MeshReport report = fe::mesh_report(mesh);
  const double m = 2700 * kArea * 2;
  for (int i = 0; i < 3; ++i) CHECK(relative(report.mass.mass(i), m) <= 1e-14);
  CHECK((report.mass.centre - Vector3d(1, 0, 0)).norm() <= 1e-14);
  const Vector3d expected(2700 * (kIy + kIz) * 2, m * 4 / 12, m * 4 / 12);
  for (int i = 0; i < 3; ++i) CHECK(relative(report.mass.inertia(i, i), expected(i)) <= 1e-13);
  CHECK(report.KR_terms <= 1e-14);
  // Masses of the points: half an element at the ends.
  REQUIRE(report.geometry.has_value());
  CHECK(relative(report.geometry->inertia(1, 1), m * (4.0 / 12 + 4.0 / 6 / 25)) <= 1e-12);
  CHECK(mesh.points.size() == 6);
  CHECK(mesh.points[2].position == Vector3d(0.8, 0, 0));
  const ModalData at_2 = fe::modal_data(mesh, "2", {"P", "C", "4"});
  CHECK(at_2.omega.size() == 30);
  CHECK(at_2.children[0].PC == Vector3d(-0.8, 0, 0));
}

TEST_CASE("sections") {
  const Section r = rectangle(0.06, 0.04);
  CHECK(relative(r.area, kArea) <= 1e-15);
  CHECK(relative(r.I_y, kIy) <= 1e-15);
  CHECK(relative(r.I_z, kIz) <= 1e-15);
  // [Timoshenko 1951] table: 0.1406 a^4 for a square, 0.229 a b^3 for 2 : 1, 0.312 for 10 : 1.
  CHECK(std::abs(rectangle(1, 1).J - 0.1406) <= 5e-5);
  CHECK(relative(rectangle(1, 1).J, 0.14057701495515551) <= 1e-12);
  CHECK(std::abs(rectangle(2, 1).J / 2 - 0.229) <= 5e-4);
  CHECK(std::abs(rectangle(1, 10).J / 10 - 0.312) <= 6e-4);
  CHECK(rectangle(3, 5).J == rectangle(5, 3).J);
  const Section c = circle(0.1);
  CHECK(relative(c.I_y, pi * 1e-4 / 64) <= 1e-15);
  CHECK(relative(c.J, pi * 1e-4 / 32) <= 1e-15);
  const Section t = tube(0.1, 0.09);
  CHECK(relative(t.area, pi / 4 * (0.01 - 0.0081)) <= 1e-13);
  CHECK(relative(t.I_z, pi / 64 * (1e-4 - 6.561e-5)) <= 1e-13);
  CHECK(t.J == t.I_y + t.I_z);
}

TEST_CASE("a beam that cannot be is refused, all mistakes at once") {
  CHECK(says(error_of([] { beam_mesh({.length = -1}); }), Code::bad_value, {"length", "-1"}));
  const Error all = error_of([] { beam_mesh(Beam{}); });
  for (const char* subject : {"length", "section.area", "section.I_y", "section.I_z", "section.J",
                              "material.E", "material.rho"})
    CHECK(says(all, Code::bad_value, {subject, "0"}));
  CHECK(says(all, Code::bad_value, {"nu", "G"}));
  Beam beam = plank(2);
  beam.material.G = 26e9;
  CHECK(says(error_of([&] { beam_mesh(beam); }), Code::bad_value, {"nu", "G"}));
  beam.material.nu.reset();
  CHECK(error_of([&] { beam_mesh(beam); }).mistakes().empty());
  for (const double nu : {33.0, 0.7, -1.0, std::nan("")}) {
    Beam percent = plank(2);
    percent.material.nu = nu;
    CHECK(says(error_of([&] { beam_mesh(percent); }), Code::bad_value, {"material.nu"}));
  }
  beam.elements = 0;
  CHECK(says(error_of([&] { beam_mesh(beam); }), Code::bad_value, {"elements", "0"}));
  CHECK(says(error_of([] { rectangle(0, 1); }), Code::bad_value, {"width", "0"}));
  CHECK(says(error_of([] { tube(1, 1); }), Code::bad_value, {"1", "tube(outer, inner)"}));
}
