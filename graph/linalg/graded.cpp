#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/graded.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <vector>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRigid = 1e-13;    ///< of a diagonal entry, of lambda_max: smaller is rounding
constexpr double kOfTerms = 1e-12;  ///< an entry of a congruence, of its terms, likewise

/// L with S = L L', rows in their places, columns by falling pivots. `least` is the least pivot
/// over its diagonal entry of S. Empty if that is only rounding: a rigid motion.
MatrixXd pivoted_cholesky(const MatrixXd& S, double& least) {
  const Eigen::LDLT<MatrixXd> ldl(S);
  const VectorXd d = ldl.vectorD(), diagonal = ldl.transpositionsP() * VectorXd(S.diagonal());
  least = ldl.info() == Eigen::Success ? (d.array() / diagonal.array()).minCoeff() : 0;
  if (!(least > kRigid) || !(diagonal.minCoeff() > 0)) return {};
  const MatrixXd L = ldl.matrixL();
  return ldl.transpositionsP().transpose() * MatrixXd(L * d.cwiseSqrt().asDiagonal());
}

/// Orthogonality of two columns: to the rounding of their product (fine), to an angle below
/// rounding (good), or not yet (open). A small column is orthogonal to a large one long before its
/// component along it has digits.
enum class Angle { fine, good, open };

/// Rotates two columns towards orthogonality; returns their angle before.
Angle turn(MatrixXd& L, Index i, Index j) {
  const double a = L.col(i).squaredNorm(), b = L.col(j).squaredNorm(), c = L.col(i).dot(L.col(j));
  const double tolerance = std::sqrt(static_cast<double>(L.rows())) * linalg::kEpsilon;
  if (std::abs(c) <= tolerance * L.col(i).cwiseAbs().dot(L.col(j).cwiseAbs())) return Angle::fine;
  const double z = (b - a) / (2 * c);
  const double t = std::copysign(1.0, z) / (std::abs(z) + std::hypot(1.0, z));
  const double cosine = 1 / std::hypot(1.0, t);
  L.applyOnTheRight(i, j, Eigen::JacobiRotation<double>(cosine, cosine * t));
  return std::abs(c) <= tolerance * std::sqrt(a) * std::sqrt(b) ? Angle::good : Angle::open;
}

/// L V = U diag(sigma), V made of rotations of two columns each. Leaves U diag(sigma) in L; false
/// if it does not converge. Once all angles are good, at most four sweeps more.
bool orthogonalize(MatrixXd& L) {
  for (int sweep = 0, good = 0; sweep < 40; ++sweep) {
    Angle worst = Angle::fine;
    for (Index i = 0; i + 1 < L.cols(); ++i)
      for (Index j = i + 1; j < L.cols(); ++j) worst = std::max(worst, turn(L, i, j));
    if (worst == Angle::fine) return true;
    good = worst == Angle::good ? good + 1 : 0;
    if (good == 4) return true;
  }
  return false;
}

GradedModes all_alike(const MatrixXd& S) {
  GradedModes result{eigh(S), false, std::numeric_limits<double>::infinity()};
  VectorXd& lambda = result.modes.lambda;
  const double largest = lambda.size() ? lambda.cwiseAbs().maxCoeff() : 0;
  lambda = (lambda.array().abs() <= kRigid * largest).select(0, lambda);
  return result;
}

}  // namespace

GradedModes eigh_graded(const MatrixXd& S) {
  const Index n = S.rows();
  if (n == 0 || !S.allFinite()) return all_alike(S);
  double least = 0;
  MatrixXd L = pivoted_cholesky(S, least);
  if (L.size() == 0 || !orthogonalize(L)) return all_alike(S);
  const VectorXd lambda = L.colwise().squaredNorm();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return lambda(a) < lambda(b); });
  GradedModes result{{lambda(order), L(Eigen::all, order)},
                     true,
                     static_cast<double>(n) * linalg::kEpsilon / least};
  for (Index k = 0; k < n; ++k) {
    auto v = result.modes.V.col(k);
    v.normalize();
    Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    if (v(largest) < 0) v *= -1;
  }
  return result;
}

std::optional<VectorXd> diagonal_in(const GradedModes& of, const MatrixXd& Z) {
  const MatrixXd& V = of.modes.V;
  const MatrixXd in = V.transpose() * Z * V;
  const double size = in.size() ? in.cwiseAbs().maxCoeff() : 0;
  const MatrixXd terms = V.cwiseAbs().transpose() * Z.cwiseAbs() * V.cwiseAbs();
  for (Index j = 0; j < in.cols(); ++j)
    for (Index i = 0; i < in.rows(); ++i)
      if (i != j && !(std::abs(in(i, j)) <= (of.graded ? kOfTerms * terms(i, j) : kRigid * size)))
        return std::nullopt;
  return VectorXd(
      (in.diagonal().array().abs() <= kRigid * terms.diagonal().array()).select(0, in.diagonal()));
}

bool symmetric_in(const GradedModes& of, const MatrixXd& S, const MatrixXd& skew) {
  const auto& [lambda, V] = of.modes;
  const MatrixXd in = V.transpose() * skew * V;
  const MatrixXd terms = V.cwiseAbs().transpose() * S.cwiseAbs() * V.cwiseAbs();
  for (Index j = 0; j < in.cols(); ++j)
    for (Index i = 0; i < in.rows(); ++i) {
      const double own = std::sqrt(std::abs(lambda(i))) * std::sqrt(std::abs(lambda(j)));
      if (!(std::abs(in(i, j)) <= std::max(kOfTerms * terms(i, j), linalg::kMatrixDigits * own)))
        return false;
    }
  return true;
}

}  // namespace titop
