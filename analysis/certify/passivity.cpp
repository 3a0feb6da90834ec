#include <algorithm>
#include <cmath>
#include <titop/analysis/certify/passivity.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::certification {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Possible rounding of each entry of G / s: at least that of the largest entry of the same units,
/// as along a locked axis.
MatrixXd floors(const DualTransfers& t, std::size_t point) {
  const double s = std::abs(t.points[point]);
  MatrixXd result(t.G[point].rows(), t.G[point].cols());
  for (Index row = 0; const Index n : t.by.rows) {
    for (Index column = 0; const Index m : t.by.cols) {
      const double largest = t.G[point].block(row, column, n, m).cwiseAbs().maxCoeff();
      const double rounding =
          std::max(t.floor(row, column, n, m), linalg::kProductRounding * largest);
      result.block(row, column, n, m).setConstant(rounding / s);
      column += m;
    }
    row += n;
  }
  return result;
}

/// Axis i has neither a response to any force nor an effect on any motion, up to rounding.
bool is_held(const MatrixXcd& H, const MatrixXd& floor, Index i) {
  return H(i, i) == 0.0 && (H.row(i).cwiseAbs().array() <= floor.row(i).array()).all() &&
         (H.col(i).cwiseAbs().array() <= floor.col(i).array()).all();
}

/// Smallest eigenvalue of H + H' with its diagonal, which rounding may have made smaller by
/// `floor`, scaled to 1.
double least(const MatrixXcd& H, const MatrixXd& floor) {
  if (!H.allFinite()) return -1;
  const Eigen::VectorXd diagonal = H.diagonal().real() + floor.diagonal();
  std::vector<Index> moving;
  for (Index i = 0; i < H.rows(); ++i) {
    if (is_held(H, floor, i)) continue;
    if (H(i, i) == 0.0 && diagonal(i) == 0) return -1;  // moved by others alone
    if (!(diagonal(i) > 0)) return diagonal(i) / std::abs(H(i, i));
    moving.push_back(i);
  }
  if (moving.empty()) return 1;
  MatrixXcd both = (H + H.adjoint())(moving, moving) / 2;
  both.diagonal() = diagonal(moving).cast<std::complex<double>>();
  const Eigen::VectorXd scale = diagonal(moving).cwiseSqrt().cwiseInverse();
  both = scale.asDiagonal() * both * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(both, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

}  // namespace

FullCertificate::Passivity check_passivity(const passes::DualPairs& pairs,
                                           const DualTransfers& transfers, bool structure) {
  FullCertificate::Passivity p;
  p.structure = structure;
  p.pairs = pairs.count;
  if (p.pairs == 0) {
    p.why_not = passes::DualPairs::kNone;
    return p;
  }
  p.done = true;
  p.least = 1;
  for (std::size_t k = 0; k < transfers.points.size(); ++k) {
    const std::complex<double> s = transfers.points[k];
    const double now = least(transfers.G[k] / s, floors(transfers, k));
    if (now < p.least) p.least = now, p.where = s;
  }
  return p;
}

}  // namespace titop::certification
