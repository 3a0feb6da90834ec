#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "boom.hpp"
#include "dynamics.hpp"

/// Residual vectors: exact statics with few modes, and their benefit under load. All expected
/// numbers from M and K directly.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::boom;
using fe_test::relative;

namespace {

fe::Mesh calculix_beam() {
  return fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                           {{"P", 900001}, {"C", 900003}});
}

std::vector<Index> without(const fe::Mesh& mesh, const std::string& name) {
  const auto rows = fe::interface_rows(mesh, name);
  std::vector<Index> f;
  for (Index i = 0; i < mesh.M.rows(); ++i)
    if (std::find(rows.begin(), rows.end(), i) == rows.end()) f.push_back(i);
  return f;
}

/// Displacements at C per unit wrench at C, clamped at P: 6 x 6 from K.
Matrix6 flexibility(const fe::Mesh& mesh) {
  const auto f = without(mesh, "P");
  MatrixXd inverse = MatrixXd::Zero(mesh.K.rows(), mesh.K.rows());
  const MatrixXd K_ff = mesh.K(f, f);
  inverse(f, f) = solve_definite(K_ff, MatrixXd::Identity(K_ff.rows(), K_ff.rows()));
  const auto C = fe::interface_rows(mesh, "C");
  return inverse(C, C);
}

Matrix6 flexibility(const ModalData& data) {
  const MatrixXd& Phi = data.children[0].Phi_C;
  return Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
}

double scaled_error(const Matrix6& a, const Matrix6& b) {
  const Vector6 scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

/// A heavy body at C: 40 kg, its centre of mass 0.3 m ahead.
Matrix6 load() { return rigid_mass(40, Vector3d(2, 3, 4).asDiagonal(), Vector3d(-0.3, 0, 0)); }

/// omegas of the structure clamped at P with the load at C, from M and K.
VectorXd loaded_omegas(const fe::Mesh& mesh) {
  MatrixXd M = mesh.M;
  const auto C = fe::interface_rows(mesh, "C");
  M(C, C) += load();
  const auto f = without(mesh, "P");
  return eigh_definite(mesh.K(f, f), M(f, f)).lambda.cwiseSqrt();
}

/// The same from (14): F = -load xdd_C, xdd_P = 0.
VectorXd loaded_omegas(const ModalData& data) {
  const MatrixXd& Phi = data.children[0].Phi_C;
  const Index N = data.omega.size();
  const MatrixXd M = MatrixXd::Identity(N, N) + Phi.transpose() * load() * Phi;
  return eigh_definite(data.omega.cwiseAbs2().asDiagonal().toDenseMatrix(), M).lambda.cwiseSqrt();
}

/// omegas of the free structure from (14): F_A/P = 0, no child; the elastic ones.
VectorXd free_omegas(const ModalData& data) {
  const Index N = data.omega.size();
  const MatrixXd M =
      MatrixXd::Identity(N, N) - data.L_P * data.D_P.inverse() * data.L_P.transpose();
  return eigh_definite(data.omega.cwiseAbs2().asDiagonal().toDenseMatrix(), M).lambda.cwiseSqrt();
}

}  // namespace

TEST_CASE("statics at C are exact with any number of modes, down to none") {
  const fe::Mesh mesh = boom(12);
  const Matrix6 exact = flexibility(mesh);
  for (const int kept : {0, 1, 2, 6, 20, 66, 71, 72}) {
    INFO(kept, " kept");
    const ModalData data = fe::modal_data(mesh, "P", {"C"}, {.kept = kept, .residual = {"C"}});
    CHECK(data.omega.size() <= 72);
    if (kept <= 20) CHECK(data.omega.size() == kept + 6);
    CHECK(scaled_error(flexibility(data), exact) <= 1e-10);
    for (Index k = 1; k < data.omega.size(); ++k) CHECK(data.omega(k) >= data.omega(k - 1));
  }
  const ModalData plain = fe::modal_data(mesh, "P", {"C"}, {.kept = 6});
  CHECK(scaled_error(flexibility(plain), exact) > 0.5);  // neither axial nor torsion
}

TEST_CASE("statics at the end of the CalculiX beam") {
  const fe::Mesh mesh = calculix_beam();
  const ModalData data = fe::modal_data(mesh, "P", {"C"}, {.kept = 4, .residual = {"C"}});
  CHECK(data.omega.size() == 10);
  CHECK(scaled_error(flexibility(data), flexibility(mesh)) <= 1e-9);
}

TEST_CASE("kept modes stay as they were, all shapes M- and K-orthonormal") {
  const fe::Mesh mesh = boom(12);
  std::vector<std::string> everywhere = {"C"};
  for (int i = 1; i < 12; ++i) everywhere.push_back(std::to_string(i));
  const fe::ModeOptions options{.kept = 5, .residual = {"C", "P", "6"}};
  const ModalData data = fe::modal_data(mesh, "P", everywhere, options);
  const ModalData plain = fe::modal_data(mesh, "P", everywhere, {.kept = 5});
  REQUIRE(data.omega.size() == 23);
  CHECK(data.omega.head(5) == plain.omega);
  CHECK(data.L_P.topRows(5) == plain.L_P);
  MatrixXd V = MatrixXd::Zero(mesh.M.rows(), 23);
  for (const ModalChild& child : data.children)
    V(fe::interface_rows(mesh, child.name), Eigen::all) = child.Phi_C;
  const MatrixXd I = MatrixXd::Identity(23, 23);
  CHECK((V.transpose() * mesh.M * V - I).cwiseAbs().maxCoeff() <= 1e-12);
  const VectorXd scale = data.omega.cwiseInverse();
  const MatrixXd stiffness = scale.asDiagonal() * V.transpose() * mesh.K * V * scale.asDiagonal();
  CHECK((stiffness - I).cwiseAbs().maxCoeff() <= 1e-11);
}

TEST_CASE("residual vectors of neighbours, nearly the same, stay orthonormal") {
  const fe::Mesh mesh = boom(12);
  std::vector<std::string> everywhere = {"C"};
  for (int i = 1; i < 12; ++i) everywhere.push_back(std::to_string(i));
  const ModalData data = fe::modal_data(mesh, "P", everywhere,
                                        {.kept = 0, .residual = {"C", "P", "11", "10", "9", "8"}});
  const Index N = data.omega.size();
  CHECK(N > 20);
  MatrixXd V = MatrixXd::Zero(mesh.M.rows(), N);
  for (const ModalChild& child : data.children)
    V(fe::interface_rows(mesh, child.name), Eigen::all) = child.Phi_C;
  CHECK((V.transpose() * mesh.M * V - MatrixXd::Identity(N, N)).cwiseAbs().maxCoeff() <= 1e-12);
  CHECK(scaled_error(flexibility(data), flexibility(mesh)) <= 1e-9);
}

TEST_CASE("a loaded cantilever: 2 modes and 6 residual vectors beat 12 and 24 modes") {
  const fe::Mesh mesh = boom(12);
  const VectorXd exact = loaded_omegas(mesh);
  const auto worst_of_4 = [&](const fe::ModeOptions& options) {
    const VectorXd omega = loaded_omegas(fe::modal_data(mesh, "P", {"C"}, options));
    double worst = 0;
    for (Index k = 0; k < 4; ++k) worst = std::max(worst, relative(omega(k), exact(k)));
    return worst;
  };
  CHECK(worst_of_4({}) <= 1e-11);
  CHECK(worst_of_4({.kept = 6}) > 0.3);
  CHECK(worst_of_4({.kept = 12}) > 0.1);
  CHECK(worst_of_4({.kept = 24}) > 3e-3);
  CHECK(worst_of_4({.kept = 0, .residual = {"C"}}) <= 2e-2);
  CHECK(worst_of_4({.kept = 2, .residual = {"C"}}) <= 3e-4);
  CHECK(worst_of_4({.kept = 6, .residual = {"C"}}) <= 1e-6);
}

TEST_CASE("a released parent: its residual vectors help the free modes") {
  const fe::Mesh mesh = boom(12);
  const VectorXd all = eigh(mesh.K, mesh.M).lambda;
  const double exact = std::sqrt(all(6));
  const auto error = [&](const fe::ModeOptions& options) {
    return relative(free_omegas(fe::modal_data(mesh, "P", {}, options))(0), exact);
  };
  CHECK(error({}) <= 1e-8);
  CHECK(error({.kept = 6}) > 1e-3);
  CHECK(error({.kept = 6, .residual = {"P"}}) <= 1e-5);
}

TEST_CASE("damping: one for all, one per kept mode, one for each") {
  const fe::Mesh mesh = boom(12);
  const auto xi = [&](std::vector<double> given) {
    return fe::modal_data(mesh, "P", {"C"}, {.kept = 2, .residual = {"C"}, .xi = given}).xi;
  };
  CHECK(xi({}) == VectorXd::Zero(8));
  CHECK(xi({0.01}) == VectorXd::Constant(8, 0.01));
  CHECK(xi({0.01, 0.02}) == (VectorXd(8) << .01, .02, .02, .02, .02, .02, .02, .02).finished());
  CHECK(xi({.1, .2, .3, .4, .5, .6, .7, .8}) ==
        (VectorXd(8) << .1, .2, .3, .4, .5, .6, .7, .8).finished());
  CHECK_THROWS_WITH(
      xi({.1, .2, .3}),
      "error[size]: 3 damping ratios given for mesh beam, which has 2 kept modes and 6 "
      "residual vectors\n  give one for all, one per kept mode, or one for each "
      "including the residual vectors");
  CHECK_THROWS_WITH(xi({-0.1}),
                    "error[bad-value]: damping ratio -0.1 of mesh beam is not a number >= 0\n  "
                    "give fractions of critical damping: 0.005 is half a percent");
}
