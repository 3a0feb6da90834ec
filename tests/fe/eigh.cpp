#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>

#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// The symmetric eigenproblems: residuals, orthogonality, the loss of digits of a slender structure
/// by each method, refusals.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::error_of;
using titop_test::says;

namespace {

MatrixXd random_definite(Index n, unsigned seed) {
  const MatrixXd A = std::sqrt(3.0) * titop_test::Rng(seed).matrix(n, n);  // of variance 1
  return A * A.transpose() + 0.1 * double(n) * MatrixXd::Identity(n, n);
}

double largest(const MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

double orthogonality(const MatrixXd& V, const MatrixXd& M) {
  return largest(V.transpose() * M * V - MatrixXd::Identity(V.cols(), V.cols()));
}

/// Largest |V'KV - diag(lambda)|, entry (i, j) over omega_i omega_j: error of the shapes in energy.
double energy_error(const MatrixXd& K, const SymmetricModes& modes) {
  const VectorXd scale = modes.lambda.cwiseSqrt().cwiseInverse();
  const MatrixXd G = scale.asDiagonal() * modes.V.transpose() * K * modes.V * scale.asDiagonal();
  return largest(G - MatrixXd::Identity(G.rows(), G.cols()));
}

/// Plane cantilever of unit length, stiffness and mass, clamped rows taken out.
struct Cantilever {
  MatrixXd M, K;
};

Cantilever cantilever(Index elements) {
  const double h = 1.0 / double(elements);
  Eigen::Matrix4d k, m;
  k << 12, 6 * h, -12, 6 * h, 6 * h, 4 * h * h, -6 * h, 2 * h * h, -12, -6 * h, 12, -6 * h, 6 * h,
      2 * h * h, -6 * h, 4 * h * h;
  m << 156, 22 * h, 54, -13 * h, 22 * h, 4 * h * h, 13 * h, -3 * h * h, 54, 13 * h, 156, -22 * h,
      -13 * h, -3 * h * h, -22 * h, 4 * h * h;
  const Index n = 2 * (elements + 1);
  Cantilever c{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
  for (Index e = 0; e < elements; ++e) {
    c.K.block(2 * e, 2 * e, 4, 4) += k / (h * h * h);
    c.M.block(2 * e, 2 * e, 4, 4) += m * h / 420;
  }
  c.K = MatrixXd(c.K.bottomRightCorner(n - 2, n - 2));
  c.M = MatrixXd(c.M.bottomRightCorner(n - 2, n - 2));
  return c;
}

/// First root of cos(x) cosh(x) = -1, by bisection.
double first_clamped_free_root() {
  double low = 1, high = 3;
  while (high - low > 4e-16 * high) {
    const double x = (low + high) / 2;
    (std::cos(x) * std::cosh(x) > -1 ? low : high) = x;
    if (x == low && x == high) break;
    if ((low + high) / 2 == low || (low + high) / 2 == high) break;
  }
  return low;
}

}  // namespace

TEST_CASE("eigh of the chain tridiag(-1, 2, -1) gives 2 - 2 cos(k pi / (n + 1))") {
  const Index n = 40;
  MatrixXd S = 2 * MatrixXd::Identity(n, n);
  for (Index i = 0; i + 1 < n; ++i) S(i, i + 1) = S(i + 1, i) = -1;
  const SymmetricModes modes = eigh(S);
  for (Index k = 0; k < n; ++k) {
    const double expected = 2 - 2 * std::cos(double(k + 1) * std::numbers::pi / double(n + 1));
    CHECK(std::abs(modes.lambda(k) - expected) <= 4e-15 * 4);
  }
  CHECK(orthogonality(modes.V, MatrixXd::Identity(n, n)) <= 1e-14);
}

TEST_CASE("all roads solve the same well-conditioned pair") {
  const Index n = 60;
  const MatrixXd K = random_definite(n, 1), M = random_definite(n, 2);
  const SymmetricModes general = eigh(K, M), definite = eigh_definite(K, M),
                       lowest = eigh_lowest(K, M, 7);
  for (const SymmetricModes* modes : {&general, &definite, &lowest}) {
    CHECK(energy_error(K, *modes) <= 1e-13);
    CHECK(orthogonality(modes->V, M) <= 1e-13);
    CHECK(largest(modes->V.leftCols(7) - general.V.leftCols(7)) <= 1e-12);
  }
  CHECK(largest((definite.lambda - general.lambda).cwiseQuotient(general.lambda)) <= 1e-13);
  CHECK(largest((lowest.lambda - general.lambda.head(7)).cwiseQuotient(lowest.lambda)) <= 1e-13);
}

TEST_CASE("a slender cantilever keeps its low modes by eigh_definite and eigh_lowest") {
  const Cantilever c = cantilever(200);
  const double lambda_1 = std::pow(first_clamped_free_root(), 4);  // discretization error 1e-11
  const auto error = [&](const SymmetricModes& m) { return std::abs(m.lambda(0) / lambda_1 - 1); };
  const SymmetricModes general = eigh(c.K, c.M), definite = eigh_definite(c.K, c.M),
                       lowest = eigh_lowest(c.K, c.M, 100), all = eigh_lowest(c.K, c.M, 400);
  CHECK(error(general) > 1e-7);  // the reason for the other two
  CHECK(error(definite) <= 1e-7);
  CHECK(error(lowest) <= 1e-7);
  CHECK(orthogonality(general.V, c.M) <= 1e-13);
  CHECK(orthogonality(definite.V, c.M) <= 1e-13);
  CHECK(orthogonality(lowest.V, c.M) <= 1e-13);
  CHECK(energy_error(c.K, general) > 3e-7);
  CHECK(energy_error(c.K, definite) <= 1e-7);
  CHECK(energy_error(c.K, lowest) <= 1e-7);
  // The high modes, where `general` is exact, are the other road's weak side.
  const VectorXd high = general.lambda.tail(100);
  CHECK(largest((definite.lambda.tail(100) - high).cwiseQuotient(high)) <= 1e-13);
  CHECK(largest((all.lambda.tail(100) - high).cwiseQuotient(high)) > 1e-8);
}

TEST_CASE("largest entry of an eigenvector is positive, the first one of several") {
  const SymmetricModes modes = eigh_definite(random_definite(30, 3), random_definite(30, 4));
  for (Index j = 0; j < 30; ++j) {
    Index i = 0;
    modes.V.col(j).cwiseAbs().maxCoeff(&i);
    CHECK(modes.V(i, j) > 0);
  }
  // Vectors of a symmetric chain: two largest entries each, equal up to rounding.
  MatrixXd chain = 2 * MatrixXd::Identity(40, 40);
  for (Index i = 0; i + 1 < 40; ++i) chain(i, i + 1) = chain(i + 1, i) = -1;
  const MatrixXd V = eigh(chain).V;
  for (Index j = 0; j < 40; ++j) {
    Index i = 0;
    V.col(j).head(20).cwiseAbs().maxCoeff(&i);
    CHECK(V(i, j) > 0);
  }
  const SymmetricModes pair = eigh((MatrixXd(2, 2) << 2, 1, 1, 2).finished());
  CHECK(pair.V(0, 0) > 0);
  CHECK(pair.V(1, 0) < 0);
}

TEST_CASE("only lower triangles are read") {
  MatrixXd K = random_definite(8, 5), M = random_definite(8, 6);
  const SymmetricModes before = eigh_definite(K, M), low = eigh_lowest(K, M, 3);
  K.triangularView<Eigen::StrictlyUpper>().setConstant(1e9);
  M.triangularView<Eigen::StrictlyUpper>().setConstant(-1e9);
  CHECK(largest(eigh_definite(K, M).V - before.V) == 0);
  CHECK(largest(eigh_lowest(K, M, 3).V - low.V) == 0);
  CHECK(largest(eigh(K, M).lambda - before.lambda) <= 1e-12 * before.lambda.maxCoeff());
}

TEST_CASE("massless degrees of freedom: finite modes only") {
  MatrixXd K = random_definite(6, 7), M = MatrixXd::Identity(6, 6);
  M(5, 5) = 0;
  M(2, 2) = 0;
  // By condensation: rows 2 and 5 follow the others statically.
  const std::vector<Index> a = {0, 1, 3, 4}, b = {2, 5};
  const MatrixXd Kaa = K(a, a), Kab = K(a, b), Kbb = K(b, b);
  const SymmetricModes expected = eigh(Kaa - Kab * Kbb.inverse() * Kab.transpose());
  const SymmetricModes modes = eigh_lowest(K, M, 4);
  CHECK(largest(modes.lambda - expected.lambda) <= 1e-13 * expected.lambda(3));
  CHECK(orthogonality(modes.V, M) <= 1e-13);
  CHECK(says(error_of([&] { eigh_lowest(K, M, 5); }), Code::bad_value, {"5", "4", "6"}));
}

TEST_CASE("refusals name the row") {
  MatrixXd K = random_definite(5, 8);
  const MatrixXd M = random_definite(5, 9);
  MatrixXd bad = M;
  bad(3, 3) = -1;
  CHECK(says(error_of([&] { eigh(K, bad); }), Code::singular, {"M", "row 3"}));
  CHECK(says(error_of([&] { eigh_definite(bad, M); }), Code::singular, {"K", "row 3"}));
  CHECK(says(error_of([&] { eigh_lowest(bad, M, 2); }), Code::singular, {"K", "row 3"}));
  CHECK(says(error_of([&] { solve_definite(bad, M); }), Code::singular, {"K", "row 3"}));
  CHECK(says(error_of([&] { eigh(K, MatrixXd::Identity(4, 4)); }), Code::size,
             {"K", "5 x 5", "M", "4 x 4"}));
  CHECK(says(error_of([&] { eigh(MatrixXd::Zero(2, 3)); }), Code::size, {"S", "2 x 3"}));
  CHECK(says(error_of([&] { solve_definite(K, MatrixXd::Zero(4, 1)); }), Code::size,
             {"K", "5", "B", "4"}));
  K(2, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(error_of([&] { eigh_definite(K, M); }), Code::not_finite, {"K(2, 1)", "nan"}));
}

TEST_CASE("weak_pivot does not depend on units") {
  MatrixXd S = random_definite(6, 10);
  CHECK(weak_pivot(S) == -1);
  S.row(4) = S.row(1) + S.row(2);
  S.col(4) = S.col(1) + S.col(2);
  S(4, 4) = S(1, 4) + S(2, 4);
  const VectorXd units = (VectorXd(6) << 1, 1e9, 1e-8, 1e3, 1e-9, 1).finished();
  CHECK(weak_pivot(S, 1e-13) == 4);
  CHECK(weak_pivot(units.asDiagonal() * S * units.asDiagonal(), 1e-13) == 4);
  CHECK(weak_pivot(MatrixXd(0, 0)) == -1);
}

TEST_CASE("nothing has no modes") {
  const MatrixXd none(0, 0);
  CHECK(eigh(none).lambda.size() == 0);
  CHECK(eigh(none, none).lambda.size() == 0);
  CHECK(eigh_definite(none, none).lambda.size() == 0);
  CHECK(eigh_lowest(none, none, 0).lambda.size() == 0);
  CHECK(eigh_lowest(random_definite(3, 11), random_definite(3, 12), 0).V.rows() == 3);
}

TEST_CASE("a short beam clamped inside: motions that nothing couples are not mixed") {
  // Bending in two planes, torsion and length of both halves.
  Beam beam{.length = 0.31474084908011568,
            .section = {.area = 0.0012352854566836154,
                        .I_y = 2.8587265759723099e-08,
                        .I_z = 1.7434166891898604e-07,
                        .J = 1.9840032355771062e-07},
            .material = {.E = 47397.161026027119, .rho = 6969.0223710365162},
            .elements = 3};
  beam.section.I_x = 2.0844613696903259e-07;
  beam.material.nu = -0.13132845400995857;
  const fe::Mesh mesh = beam_mesh(beam);
  std::vector<Index> rows;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.points[mesh.dofs[i].point].name != "2") rows.push_back(static_cast<Index>(i));
  REQUIRE(rows.size() == 18);
  const MatrixXd K = mesh.K(rows, rows), M = mesh.M(rows, rows);
  const SymmetricModes modes = eigh_definite(K, M);
  CHECK(energy_error(K, modes) <= 1e-10);
  CHECK(orthogonality(modes.V, M) <= 1e-10);
}
