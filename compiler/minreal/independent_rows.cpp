#include <algorithm>
#include <cmath>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/independent_rows.hpp>
#include <titop/compiler/minreal/staircase.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// Weight in pivoting of a row of the next level: integrators leave before other states unless a
/// coefficient of T would exceed 1e3. It decides which state leaves, not how many: with 1e-6,
/// coefficients cost the transfer three digits (tests/minreal/digits.cpp); with 0.03, modes of a
/// beam leave before rates of its hub, and a rigid motion has five digits at 1e-5 of the first
/// mode, not fifteen (tests/minreal/axial.cpp).
constexpr double kLater = 1e-3;
constexpr double kOfNoise = 1e12;  ///< times rounding: its weight in the scaling of rows

/// Factors that bring the largest entries of all rows and columns to 1 [Ruiz 2001]; rows and
/// columns of zeros keep theirs. Which factors these are depends on where the sweeps begin: at the
/// scaling that brings all clear entries nearest to 1, which is the same in any units. (From the
/// units of the states, couplings to a slow part would hide its own entries.)
struct UnitScale {
  VectorXd row, column;
  UnitScale(const MatrixXd& clear, MatrixXd sizes) {
    linalg::TwoSidedScaling start = linalg::two_sided_scaling(clear);
    row = std::move(start.row);
    column = std::move(start.column);
    constexpr int kSweeps = 20;
    const auto unit = [](const VectorXd& size) {
      return VectorXd((size.array() > 0).select(size.cwiseSqrt().cwiseInverse(), 1.0));
    };
    sizes = (row.asDiagonal() * sizes * column.asDiagonal()).eval();
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const VectorXd r = unit(sizes.rowwise().maxCoeff()), c = unit(sizes.colwise().maxCoeff());
      sizes = (r.asDiagonal() * sizes * c.asDiagonal()).eval();
      row.array() *= r.array();
      column.array() *= c.array();
    }
  }
  MatrixXd operator()(const MatrixXd& M) const {
    return row.asDiagonal() * M * column.asDiagonal();
  }
};

/// Some rows, and the rounding in the norm of each.
struct NoisyRows {
  std::vector<int> number;
  MatrixXd rows;
  VectorXd noise;
};

/// Rows that a pivoted QR separates clearly, and the remainders of the others.
struct SeparatedRows {
  std::vector<int> clear;
  NoisyRows others;
};
SeparatedRows separate(const NoisyRows& of) {
  SeparatedRows result;
  if (of.rows.size() == 0) {  // no row, or none with a remainder
    result.others = of;
    return result;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(of.rows.transpose());
  const MatrixXd R = qr.matrixR().triangularView<Eigen::Upper>();
  const auto& place = qr.colsPermutation().indices();
  const Index all = R.cols(), pivots = std::min(R.rows(), all);
  VectorXd noise(all);
  for (Index j = 0; j < all; ++j) noise(j) = of.noise(place(j));
  // Rounding in the remainder of row j beside the first `taken` ones: its own and theirs.
  const auto bound = [&](Index j, Index taken) {
    const VectorXd part = R.col(j).head(taken);
    const VectorXd share =
        R.topLeftCorner(taken, taken).triangularView<Eigen::Upper>().solve(part).cwiseAbs();
    return noise(j) + share.dot(noise.head(taken));
  };
  Index rank = 0;
  while (rank < pivots && std::abs(R(rank, rank)) > kClearly * bound(rank, rank))
    result.clear.push_back(of.number[at(place(rank++))]);
  result.others.rows = R.bottomRightCorner(R.rows() - rank, all - rank).transpose();
  result.others.noise.resize(all - rank);
  for (Index j = rank; j < all; ++j) {
    result.others.number.push_back(of.number[at(place(j))]);
    result.others.noise(j - rank) = bound(j, rank);
  }
  return result;
}

/// Rows `number` of these, in the units of their states.
NoisyRows weighted(const std::vector<int>& number, const MatrixXd& scaled, const MatrixXd& rounding,
                   const VectorXd& weight) {
  const VectorXd noise =
      rounding.rowwise().norm().cwiseMax(kEpsilon * scaled.rowwise().norm()).cwiseProduct(weight);
  const MatrixXd rows = weight.asDiagonal() * scaled;
  return {number, rows(number, Eigen::all), noise(number)};
}

/// Separates the rows, and their remainders again in units of their rounding: returns the
/// clearly independent rows, and the others with their remainders.
SeparatedRows separate_twice(const NoisyRows& open) {
  SeparatedRows result = separate(open);
  NoisyRows& others = result.others;
  const std::vector<int> number = others.number;
  const VectorXd bounds = others.noise;
  others.rows = bounds.cwiseInverse().asDiagonal() * others.rows;
  others.noise.setOnes();
  const SeparatedRows second = separate(others);
  result.clear.insert(result.clear.end(), second.clear.begin(), second.clear.end());
  others = second.others;
  for (Index k = 0; k < others.noise.size(); ++k) {
    const auto place = std::find(number.begin(), number.end(), others.number[at(k)]);
    const double size = bounds(place - number.begin());
    others.noise(k) *= size;
    others.rows.row(k) *= size;
  }
  return result;
}

/// Coefficients of the rows `out` by those of the basis, without those at rounding level.
void solve_for(const std::vector<int>& basis, const MatrixXd& scaled, const VectorXd& row_scale,
               IndependentRows& r) {
  r.T = MatrixXd::Zero(std::ssize(r.out), std::ssize(r.keep));
  if (basis.empty() || r.out.empty()) return;
  std::vector<int> out;
  for (const IndependentRows::RowRemainder& o : r.out) out.push_back(o.row);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(MatrixXd(scaled(basis, Eigen::all).transpose()));
  const MatrixXd share = qr.solve(MatrixXd(scaled(out, Eigen::all).transpose())).transpose();
  // Of each coefficient per change of the row that it is found from.
  const VectorXd sensitivity =
      qr.solve(MatrixXd(MatrixXd::Identity(scaled.cols(), scaled.cols()))).rowwise().norm();
  for (Index k = 0; k < share.cols(); ++k) {
    const int row = basis[at(k)];
    const Index place = std::lower_bound(r.keep.begin(), r.keep.end(), row) - r.keep.begin();
    for (Index i = 0; i < share.rows(); ++i)
      if (std::abs(share(i, k)) > detail::kRoundingFactor * r.out[at(i)].bound *
                                      scaled.row(out[at(i)]).norm() * sensitivity(k))
        r.T(i, place) = share(i, k) * row_scale(row) / row_scale(out[at(i)]);
  }
}

}  // namespace

IndependentRows independent_rows(const MatrixXd& M, const MatrixXd& rounding, const VectorXd& unit,
                                 const std::vector<int>& level) {
  IndependentRows r;
  if (M.size() == 0) return r;
  const MatrixXd clear =
      (M.array().abs() > detail::kRoundingFactor * rounding.array()).select(M, 0.0);
  // A column that distinguishes some rows may be at rounding level in the others, and large: it
  // must not dominate these.
  const UnitScale by(clear, clear.cwiseAbs().cwiseMax(kOfNoise * rounding));
  const MatrixXd scaled = by(clear);
  VectorXd weight(M.rows());
  std::vector<int> open;
  for (int i = 0; i < M.rows(); ++i) {
    weight(i) = std::pow(kLater, level[at(i)]) / (unit(i) * by.row(i));
    if ((clear.row(i).array() != 0).any())
      open.push_back(i);
    else
      r.out.push_back({i, 0, 0});
  }
  const auto [basis, others] = separate_twice(weighted(open, scaled, by(rounding), weight));
  r.keep = basis;
  for (Index k = 0; k < std::ssize(others.number); ++k) {
    const int row = others.number[at(k)];
    const double size = scaled.row(row).norm() * weight(row), bound = others.noise(k) / size,
                 own = others.rows.row(k).norm() / size;
    if (own <= detail::kRoundingFactor * bound && bound <= kWarn)
      r.out.push_back({row, own, bound});
    else
      r.keep.push_back(row), r.doubtful.push_back({row, own, bound});
  }
  std::sort(r.keep.begin(), r.keep.end());
  std::sort(r.out.begin(), r.out.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  solve_for(basis, scaled, by.row, r);
  return r;
}

}  // namespace titop::minreal
