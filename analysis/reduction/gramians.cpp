#include <cmath>
#include <limits>
#include <titop/analysis/reduction/gramians.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/svd.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Factor F of the Gramian F F^H of T and B, B behind low-passes if there is a corner: these are
/// two states more per column, as a triangle below T.
MatrixXcd factor(const MatrixXcd& T, const MatrixXcd& B, double corner) {
  if (!(corner > 0)) return linalg::lyapunov_factor(T, B);
  const Index n = T.rows(), m = B.cols();
  const Complex pole = corner * std::sqrt(0.5) * Complex(-1, 1);
  MatrixXcd all = MatrixXcd::Zero(n + 2 * m, n + 2 * m), drive = MatrixXcd::Zero(n + 2 * m, m);
  all.topLeftCorner(n, n) = T;
  for (Index j = 0; j < m; ++j) {
    const Index at = n + 2 * j;
    all.col(at).head(n) = B.col(j);
    all(at, at) = pole;
    all(at, at + 1) = corner;
    all(at + 1, at + 1) = std::conj(pole);
    drive(at + 1, j) = corner;
  }
  return linalg::lyapunov_factor(all, drive).topRows(n);
}

/// Square real L with L L' = F F^H, which is real.
MatrixXd real_factor(const MatrixXcd& F) {
  MatrixXd both(2 * F.cols(), F.rows());
  both << F.real().transpose(), F.imag().transpose();
  const Eigen::HouseholderQR<MatrixXd> qr(both);
  return MatrixXd(qr.matrixQR().topRows(F.rows()).triangularView<Eigen::Upper>()).transpose();
}

}  // namespace

Balancing balance(const Split& split, const PortSizes& sizes, double corner) {
  const Index n = split.stable.order();
  Balancing b;
  b.weighted = corner > 0;
  if (n == 0) {
    b.A.resize(0, 0);
    b.B = split.stable.B, b.C = split.stable.C;
    b.left = split.stable.left, b.right = split.stable.right;
    return b;
  }
  const MatrixXd B = split.stable.B * sizes.input.asDiagonal(),
                 C = sizes.output.cwiseInverse().asDiagonal() * split.stable.C;
  const MatrixXcd B_T = split.U.adjoint() * B.cast<Complex>(), C_T = C.cast<Complex>() * split.U;
  const MatrixXcd reached = split.U * factor(split.T, B_T, corner);
  // T^H is lower triangular: in the opposite order it is an upper one.
  const MatrixXcd seen = split.U * MatrixXcd(factor(split.T.adjoint().reverse(),
                                                    C_T.adjoint().colwise().reverse(), corner)
                                                 .colwise()
                                                 .reverse());
  const MatrixXd L = real_factor(reached), R = real_factor(seen);
  const linalg::Svd svd = linalg::svd(R.transpose() * L);
  const VectorXd& sigma = svd.sigma;
  const double least = static_cast<double>(n) * std::numeric_limits<double>::epsilon() * sigma(0);
  Index m = 0;
  while (m < n && sigma(m) > least) ++m;
  b.sigma = sigma.head(m);
  const VectorXd root = b.sigma.cwiseSqrt().cwiseInverse();
  const MatrixXd left = root.asDiagonal() * svd.U.leftCols(m).transpose() * R.transpose(),
                 right = L * svd.V.leftCols(m) * root.asDiagonal();
  b.A = left * split.stable.A * right;
  b.B = left * split.stable.B;
  b.C = split.stable.C * right;
  b.left = left * split.stable.left;
  b.right = split.stable.right * right;
  return b;
}

Cut cut(const Balancing& b, Index r, bool truncated) {
  const Index rest = b.A.rows() - r;
  Cut c;
  c.part = {b.A.topLeftCorner(r, r), b.B.topRows(r), b.C.leftCols(r), b.left.topRows(r),
            b.right.leftCols(r)};
  c.D = MatrixXd::Zero(b.C.rows(), b.B.cols());
  if (truncated || rest == 0) return c;
  const Eigen::PartialPivLU<MatrixXd> lu(b.A.bottomRightCorner(rest, rest));
  const MatrixXd x = lu.solve(MatrixXd(b.A.bottomLeftCorner(rest, r))),
                 u = lu.solve(MatrixXd(b.B.bottomRows(rest)));
  c.part.A -= b.A.topRightCorner(r, rest) * x;
  c.part.B -= b.A.topRightCorner(r, rest) * u;
  c.part.C -= b.C.rightCols(rest) * x;
  c.D = -b.C.rightCols(rest) * u;
  return c;
}

double cut_bound(const Balancing& b, Index r) {
  double sum = 0;
  for (Index j = b.sigma.size() - 1; j >= r; --j) sum += b.sigma(j);
  return 2 * sum;
}

}  // namespace titop::detail
