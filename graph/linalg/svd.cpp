#include <algorithm>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/svd.hpp>

namespace titop::linalg {

using Eigen::MatrixXd;

namespace {

constexpr unsigned int kThin = Eigen::ComputeThinU | Eigen::ComputeThinV;

template <class Decomposition>
Svd parts_of(const Decomposition& d) {
  return {d.matrixU(), d.singularValues(), d.matrixV()};
}

/// Of the norm, to the rounding of sums of so many products.
bool is_exact(const MatrixXd& M, const Svd& s) {
  const double rounding =
      static_cast<double>(std::max(M.rows(), M.cols())) * kProductRounding * s.sigma(0);
  return (M * s.V - s.U * s.sigma.asDiagonal()).norm() <= rounding;
}

}  // namespace

Svd svd(const MatrixXd& M) {
  if (M.size() == 0) return {MatrixXd(M.rows(), 0), Eigen::VectorXd(0), MatrixXd(M.cols(), 0)};
  if (const Eigen::BDCSVD<MatrixXd> d(M, kThin); d.info() == Eigen::Success)
    if (Svd s = parts_of(d); is_exact(M, s)) return s;
  const Eigen::JacobiSVD<MatrixXd> d(M, kThin);
  if (d.info() != Eigen::Success)
    throw Error(Code::singular, "the singular value iteration did not converge",
                "look for entries of extreme size");
  return parts_of(d);
}

}  // namespace titop::linalg
