#include <algorithm>
#include <titop/compiler/loops/gap.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// An orthonormal basis of the motions by these free angles (rows), rows scaled so.
MatrixXd moved_by_angles(const Form& form, const VectorXd& scale) {
  MatrixXd basis(0, scale.size());
  for (const auto& [column, matrix] : form) {
    if (column.kind != FormColumn::Kind::angle) continue;
    for (Index j = 0; j < matrix.cols(); ++j) {
      Eigen::RowVectorXd v = matrix.col(j).cwiseProduct(scale).transpose();
      const double size = v.norm();
      for (int twice = 0; twice < 2; ++twice) v -= (v * basis.transpose()) * basis;
      if (!(v.norm() > linalg::kMatrixDigits * size)) continue;
      basis.conservativeResize(basis.rows() + 1, Eigen::NoChange);
      basis.bottomRows(1) = v.normalized();
    }
  }
  return basis;
}

}  // namespace

Gap gap_of(const MatrixXd& gap, const Form& form, const std::vector<int>& units, double lever) {
  const double length = lever > 0 ? lever : 1;
  VectorXd rows(gap.rows()), columns = VectorXd::Ones(gap.cols());
  for (Index i = 0; i < rows.size(); ++i) rows(i) = units[at(i)] == 0 ? 1 / length : 1;
  columns.head(std::min<Index>(columns.size(), 3)).setConstant(length);
  const MatrixXd scaled = rows.asDiagonal() * gap * columns.asDiagonal();
  const MatrixXd basis = moved_by_angles(form, rows);
  const MatrixXd taken = basis.transpose() * (basis * scaled);
  Gap result;
  Index worst = 0, column = 0;
  result.off = (scaled - taken).cwiseAbs().maxCoeff(&worst, &column);
  if (units[at(worst)] == 0) result.length = length;
  // Rounding must not become a constraint on the meeting point.
  const MatrixXd exact = (taken.array().abs() <= linalg::kMatrixDigits).select(0.0, taken);
  if (!exact.isZero(0))
    result.taken = rows.cwiseInverse().asDiagonal() * exact * columns.cwiseInverse().asDiagonal();
  return result;
}

bool has_spring(const Form& form) {
  return std::ranges::any_of(form, [](const auto& term) {
    const auto& [column, matrix] = term;
    return column.kind == FormColumn::Kind::states && matrix.rows() == 6 &&
           Eigen::ColPivHouseholderQR<MatrixXd>(matrix).rank() == 6;
  });
}

}  // namespace titop::loops
