#include <algorithm>
#include <numeric>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/graded.hpp>

namespace titop {

GradedModes eigh_graded(const Eigen::MatrixXd& S) {
  const auto n = static_cast<int>(S.rows());
  if (n == 0 || n > 400 || !S.allFinite()) return {eigh(S), false};
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return S(a, a) > S(b, b); });
  const Eigen::LLT<Eigen::MatrixXd> cholesky(S(order, order));
  const Eigen::MatrixXd L = cholesky.matrixL();
  // A pivot that is only rounding of its own diagonal means a rigid motion.
  for (int i = 0; i < n && cholesky.info() == Eigen::Success; ++i)
    if (!(L(i, i) * L(i, i) >
          1e-13 * S(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(i)])))
      return {eigh(S), false};
  if (cholesky.info() != Eigen::Success) return {eigh(S), false};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(L, Eigen::ComputeFullU);
  GradedModes result;
  result.graded = true;
  result.modes.lambda = svd.singularValues().cwiseAbs2().reverse();
  result.modes.V.resize(n, n);
  for (int i = 0; i < n; ++i)
    result.modes.V.row(order[static_cast<std::size_t>(i)]) = svd.matrixU().row(i).reverse();
  for (int k = 0; k < n; ++k) {
    Eigen::Index largest = 0;
    result.modes.V.col(k).cwiseAbs().maxCoeff(&largest);
    if (result.modes.V(largest, k) < 0) result.modes.V.col(k) *= -1;
  }
  return result;
}

}  // namespace titop
