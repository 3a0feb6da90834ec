#include "hessenberg.hpp"

#include <Eigen/Eigenvalues>

namespace titop_bench {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

Hessenberg::Hessenberg(const titop::StateSpace& m) : D_(m.D) {
  const Eigen::HessenbergDecomposition<MatrixXd> reduced(m.A);
  const MatrixXd Q = reduced.matrixQ();
  H_ = reduced.matrixH();
  B_ = Q.transpose() * m.B;
  C_ = m.C * Q;
}

/// (s - H)^-1 B by Gauss, the pivot being one of two neighbouring rows.
MatrixXcd Hessenberg::transfer(std::complex<double> s) const {
  using Rows = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index n = H_.rows();
  Rows M = -H_.cast<std::complex<double>>(), X = B_.cast<std::complex<double>>();
  M.diagonal().array() += s;
  for (Index k = 0; k + 1 < n; ++k) {
    if (std::abs(M(k + 1, k)) > std::abs(M(k, k))) {
      M.row(k).tail(n - k).swap(M.row(k + 1).tail(n - k));
      X.row(k).swap(X.row(k + 1));
    }
    const std::complex<double> factor = M(k + 1, k) / M(k, k);
    M.row(k + 1).tail(n - k) -= factor * M.row(k).tail(n - k);
    X.row(k + 1) -= factor * X.row(k);
  }
  M.triangularView<Eigen::Upper>().solveInPlace(X);
  return C_ * X + D_.cast<std::complex<double>>();
}

}  // namespace titop_bench
