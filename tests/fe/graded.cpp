#include <doctest/doctest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numeric>
#include <titop/graph/linalg/graded.hpp>
#include <titop/graph/linalg/index.hpp>

#include "support/rng.hpp"

/// Symmetric eigenproblems over many decades: every eigenvalue and shape against 100 digits.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                           boost::multiprecision::et_off>;
using Matrix100 = std::vector<std::vector<Real>>;
using titop::linalg::at;

Matrix100 exactly(const MatrixXd& S) {
  Matrix100 m(at(S.rows()), std::vector<Real>(at(S.rows())));
  for (Index i = 0; i < S.rows(); ++i)
    for (Index j = 0; j < S.rows(); ++j) m[at(i)][at(j)] = S(i, j);
  return m;
}

/// Eigenvalues, ascending, by Jacobi's rotations from both sides until all off-diagonal entries are
/// 0.
std::vector<Real> eigenvalues(const MatrixXd& S) {
  Matrix100 m = exactly(S);
  const std::size_t n = m.size();
  for (int sweep = 0; sweep < 30; ++sweep)
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) {
        if (m[p][q] == 0) continue;
        const Real z = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const Real t = (z < 0 ? Real(-1) : Real(1)) / (abs(z) + sqrt(1 + z * z));
        const Real c = 1 / sqrt(1 + t * t), s = c * t;
        for (std::size_t k = 0; k < n; ++k) {
          const Real x = m[k][p], y = m[k][q];
          m[k][p] = c * x - s * y;
          m[k][q] = s * x + c * y;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const Real x = m[p][k], y = m[q][k];
          m[p][k] = c * x - s * y;
          m[q][k] = s * x + c * y;
        }
        m[p][q] = m[q][p] = 0;
      }
  std::vector<Real> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(m[i][i]);
  std::sort(result.begin(), result.end());
  return result;
}

/// Largest |v_i' S v_j| / sqrt(lambda_i lambda_j) off the diagonal, the product in 100 digits.
double mixing(const MatrixXd& S, const SymmetricModes& e) {
  const Matrix100 K = exactly(S), V = exactly(e.V);
  const std::size_t n = K.size();
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Real sum = 0;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) sum += V[a][i] * K[a][b] * V[b][j];
      worst = std::max(worst, std::abs(static_cast<double>(sum)) /
                                  std::sqrt(e.lambda(Index(i)) * e.lambda(Index(j))));
    }
  return worst;
}

/// D G D: G about as far from the identity as a joint between two bodies makes it, D over `decades`
/// in random order.
MatrixXd graded(Index n, double decades, std::uint64_t seed) {
  titop_test::Rng rng(seed);
  const MatrixXd X = rng.matrix(n, n);
  MatrixXd G = X * X.transpose() / static_cast<double>(n) + 0.2 * MatrixXd::Identity(n, n);
  std::vector<int> place(at(n));
  std::iota(place.begin(), place.end(), 0);
  rng.shuffle(place);
  Eigen::VectorXd D(n);
  for (Index i = 0; i < n; ++i)
    D(i) =
        std::pow(10.0, -decades * place[at(i)] / std::max<double>(1, static_cast<double>(n - 1)));
  G = D.asDiagonal() * G * D.asDiagonal();
  return (G + G.transpose()) / 2;
}

}  // namespace

TEST_CASE("graded: every eigenvalue and every shape has its digits, over any decades") {
  for (const double decades : {0.0, 3.0, 8.0, 16.0, 40.0})
    for (Index n = 1; n <= 12; ++n) {
      CAPTURE(decades);
      CAPTURE(n);
      const MatrixXd S = graded(n, decades, at(n));
      const GradedModes e = eigh_graded(S);
      REQUIRE(e.graded);
      CHECK(e.relative <= 1e-12);
      const std::vector<Real> right = eigenvalues(S);
      for (Index k = 0; k < n; ++k) {
        CAPTURE(k);
        CHECK(std::abs(static_cast<double>(e.modes.lambda(k) / right[at(k)] - 1)) <=
              std::min(1e-13, 4 * e.relative));
      }
      CHECK((e.modes.V.transpose() * e.modes.V - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff() <=
            1e-14);
      CHECK(mixing(S, e.modes) <= 1e-13);
    }
}

TEST_CASE("graded: singular matrices of 1 to 12 rows, in any units, are said to be not") {
  titop_test::Rng rng(9);
  for (Index n = 1; n <= 12; ++n)
    for (const int exponents : {0, 20}) {
      CAPTURE(n);
      CAPTURE(exponents);
      // X X' of small integers, then times powers of two: no entry is rounded.
      const MatrixXd X = (rng.matrix(n, n - 1) * 64).array().round();
      Eigen::VectorXd D(n);
      for (double& x : D) x = std::ldexp(1, -rng.below(exponents + 1));
      const MatrixXd S = D.asDiagonal() * X * X.transpose() * D.asDiagonal();
      const GradedModes e = eigh_graded(S);
      CHECK(!e.graded);
      CHECK(std::isinf(e.relative));
      const std::vector<Real> right = eigenvalues(S);
      CHECK(e.modes.lambda(0) == 0);
      for (Index k = 0; k < n; ++k)
        CHECK(std::abs(e.modes.lambda(k) - static_cast<double>(right[at(k)])) <=
              2e-13 * static_cast<double>(right.back()));
    }
}

TEST_CASE("graded: one number, equal numbers, and a shape's sign") {
  const GradedModes one = eigh_graded(MatrixXd::Constant(1, 1, 3e-7));
  CHECK(one.graded);
  CHECK(std::abs(one.modes.lambda(0) / 3e-7 - 1) <= 1e-15);
  CHECK(one.modes.V(0, 0) == 1);
  const GradedModes equal = eigh_graded(VectorXd(Eigen::Vector3d(4, 1e-20, 4)).asDiagonal());
  CHECK(equal.graded);
  CHECK((equal.modes.lambda.array() / Eigen::Array3d(1e-20, 4, 4) - 1).abs().maxCoeff() <= 1e-15);
  CHECK(equal.modes.V.cwiseAbs().colwise().maxCoeff().minCoeff() == 1);
  CHECK(equal.modes.V.minCoeff() == 0);
  CHECK(eigh_graded(MatrixXd(0, 0)).modes.lambda.size() == 0);
}

TEST_CASE("graded: rigid motions and indefinite matrices are said to be not") {
  MatrixXd chain(3, 3);  // free at both ends
  chain << 7, -7, 0, -7, 10, -3, 0, -3, 3;
  const GradedModes free = eigh_graded(chain);
  CHECK(!free.graded);
  CHECK(std::isinf(free.relative));
  CHECK(free.modes.lambda(0) == 0);  // rounding of 0 is 0
  CHECK(free.modes.lambda(1) > 1);
  MatrixXd indefinite(2, 2);
  indefinite << 1, 2, 2, 1;
  const GradedModes two = eigh_graded(indefinite);
  CHECK(!two.graded);
  CHECK(std::abs(two.modes.lambda(0) / -1 - 1) <= 1e-14);
}

namespace {

/// diag(d) + z z', both graded over n powers of two, no entry rounded.
struct RankOne {
  VectorXd d, z;

  RankOne(Index n, int exponents) : d(n), z(n) {
    titop_test::Rng rng(static_cast<std::uint64_t>(exponents));
    for (Index i = 0; i < n; ++i) {
      const int e = -rng.below(exponents + 1);
      z(i) = std::ldexp(1 + rng.below(7), e);
      d(i) = std::ldexp((1 << 19) + rng.below(1 << 20), 2 * e - 15);
    }
  }
  MatrixXd matrix() const { return MatrixXd(d.asDiagonal()) + z * z.transpose(); }
  /// Eigenvalues below x: negative squares of [D - x, z; z', -1], by either of its diagonal blocks.
  Index below(const Real& x) const {
    Index count = -1;
    Real f = 1;
    for (Index i = 0; i < d.size(); ++i) {
      count += d(i) < x;
      f += Real(z(i)) * z(i) / (d(i) - x);
    }
    return count + (f > 0);
  }
};

}  // namespace

TEST_CASE("graded: of more than 400 rows, too") {
  const RankOne S(402, 40);
  const GradedModes e = eigh_graded(S.matrix());
  REQUIRE(e.graded);
  CHECK(e.relative <= 1e-12);
  for (Index k = 0; k < S.d.size(); ++k) {
    CAPTURE(k);
    const Real lambda = e.modes.lambda(k);
    CHECK(S.below(lambda * (1 - Real(1e-12))) <= k);
    CHECK(S.below(lambda * (1 + Real(1e-12))) > k);
  }
  const MatrixXd one = e.modes.V.transpose() * e.modes.V;
  CHECK((one - MatrixXd::Identity(402, 402)).cwiseAbs().maxCoeff() <= 1e-13);
}

TEST_CASE("graded: damping that couples slow modes is not lost beside that of a fast one") {
  MatrixXd S = MatrixXd::Zero(3, 3), Z = MatrixXd::Zero(3, 3);
  S.diagonal() << 1e28, 4, 1;
  const GradedModes e = eigh_graded(S);
  Z.diagonal() << 1e14, 0.2, 0.1;
  const auto alone = diagonal_in(e, Z);
  REQUIRE(alone);
  CHECK(*alone == VectorXd(Eigen::Vector3d(0.1, 0.2, 1e14)));
  Z(1, 2) = Z(2, 1) = 0.05;
  CHECK(!diagonal_in(e, Z));
  // Proportional to the stiffness: only rounding couples modes.
  const MatrixXd graded_S = graded(8, 10, 3);
  const GradedModes modes = eigh_graded(graded_S);
  const auto damping = diagonal_in(modes, 1e-3 * graded_S);
  REQUIRE(damping);
  for (Index k = 0; k < 8; ++k)
    CHECK(std::abs((*damping)(k) / (1e-3 * modes.modes.lambda(k)) - 1) <= 1e-12);
}

TEST_CASE("graded: an antisymmetric part counts by its effect on the modes") {
  MatrixXd S = MatrixXd::Zero(3, 3), skew = MatrixXd::Zero(3, 3);
  S << 2e18, -1e9, 0, -1e9, 1, 0, 0, 0, 1;  // 2 k / m, k / m, k for m = 1e-18, k = 1; and another
  const GradedModes e = eigh_graded(S);
  CHECK(symmetric_in(e, S, skew));
  skew(0, 1) = 1e-7, skew(1, 0) = -1e-7;  // rounding of 1e9
  CHECK(symmetric_in(e, S, skew));
  skew.setZero();
  skew(1, 2) = 1e-10, skew(2, 1) = -1e-10;
  CHECK(symmetric_in(e, S, skew));
  skew(1, 2) = 1e-3, skew(2, 1) = -1e-3;
  CHECK(!symmetric_in(e, S, skew));
}
