#include <algorithm>
#include <cmath>
#include <titop/compiler/certificate/sampled.hpp>
#include <titop/compiler/minreal/independent_rows.hpp>
#include <titop/compiler/minreal/staircase.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOfNoise = 1e12;  ///< times rounding: its weight in the scaling of rows

/// Factors that bring the largest entries of all rows and columns to 1 [Ruiz 2001].
struct UnitScale {
  VectorXd row, column;
  explicit UnitScale(MatrixXd sizes)
      : row(VectorXd::Ones(sizes.rows())), column(VectorXd::Ones(sizes.cols())) {
    constexpr int kSweeps = 20;
    const auto unit = [](const VectorXd& size) {
      return VectorXd((size.array() > 0).select(size.cwiseSqrt().cwiseInverse(), 1.0));
    };
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

/// Rows are taken one by one [Gram, Schmidt, with reorthogonalization].
class RowBasis {
 public:
  RowBasis(MatrixXd M, const MatrixXd& rounding)
      : M_(std::move(M)), rest_(M_), noise_(rounding.rowwise().norm()) {}

  double own(int row) const { return rest_.row(row).norm(); }
  /// Rounding in the remainder of a row: its own, and that of the rows that were subtracted.
  double noise(int row) const {
    return noise_(row) + (coefficients(row).cwiseAbs() * noise_(taken_)).sum();
  }
  void take(int row) {
    const Eigen::RowVectorXd direction = rest_.row(row).normalized();
    for (int again = 0; again < 2; ++again)
      rest_ -= (rest_ * direction.transpose() * direction).eval();
    taken_.push_back(row);
  }
  /// A row by those that were taken: 1 x taken.
  MatrixXd coefficients(int row) const {
    if (taken_.empty()) return MatrixXd::Zero(1, 0);
    const MatrixXd basis = M_(taken_, Eigen::all).transpose(), right = M_.row(row).transpose();
    return MatrixXd(basis.completeOrthogonalDecomposition().solve(right)).transpose();
  }
  const std::vector<int>& taken() const { return taken_; }

 private:
  MatrixXd M_, rest_;
  VectorXd noise_;
  std::vector<int> taken_;
};

/// For rows at rounding level: rounding over the terms of the entries, at most.
VectorXd rounding_in(const MatrixXd& terms, const MatrixXd& rounding) {
  const UnitScale by(terms);
  const VectorXd all = by(terms).rowwise().maxCoeff(), noise = by(rounding).rowwise().maxCoeff();
  return (all.array() > 0).select(noise.cwiseQuotient(all), 0.0);
}

}  // namespace

IndependentRows independent_rows(const MatrixXd& M, const MatrixXd& rounding, const MatrixXd& terms,
                                 const std::vector<int>& level) {
  IndependentRows r;
  const MatrixXd clear = (M.array().abs() > kRounding * rounding.array()).select(M, 0.0);
  const VectorXd of_empty = rounding_in(terms, rounding);
  std::vector<int> open;
  for (int i = 0; i < M.rows(); ++i)
    if (clear.row(i).cwiseAbs().sum() > 0)
      open.push_back(i);
    else if (of_empty(i) <= kFewDigits)
      r.out.push_back({i, 0, of_empty(i)});
    else
      r.keep.push_back(i), r.doubtful.push_back({i, 0, of_empty(i)});
  // A column that distinguishes some rows may be at rounding level in the others, and large: it
  // must not dominate these.
  const UnitScale by(clear.cwiseAbs().cwiseMax(kOfNoise * rounding));
  RowBasis basis(by(clear), by(rounding));
  while (!open.empty()) {
    // On the lowest level, the row with the largest own part; of equal ones the first.
    const auto most = std::max_element(open.begin(), open.end(), [&](int a, int b) {
      const int la = level[static_cast<std::size_t>(a)], lb = level[static_cast<std::size_t>(b)];
      return la != lb ? la > lb : basis.own(a) < (1 - 1e-9) * basis.own(b);
    });
    const int i = *most;
    open.erase(most);
    const double own = basis.own(i), bound = basis.noise(i);
    if (own <= kRounding * bound && bound <= kFewDigits) {
      r.out.push_back({i, own, bound});
      continue;
    }
    r.keep.push_back(i);
    if (own > kClearly * bound)
      basis.take(i);
    else
      r.doubtful.push_back({i, own, bound});
  }
  std::sort(r.keep.begin(), r.keep.end());
  std::sort(r.out.begin(), r.out.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  r.T = MatrixXd::Zero(std::ssize(r.out), std::ssize(r.keep));
  for (std::size_t i = 0; i < r.out.size(); ++i) {
    const IndependentRows::RowRemainder& out = r.out[i];
    const MatrixXd t = basis.coefficients(out.row);
    for (std::size_t k = 0; k < basis.taken().size(); ++k) {
      const int row = basis.taken()[k];
      const auto place = std::lower_bound(r.keep.begin(), r.keep.end(), row) - r.keep.begin();
      const double c = t(0, static_cast<Index>(k));
      if (std::abs(c) > kRounding * out.bound)
        r.T(static_cast<Index>(i), place) = c * by.row(row) / by.row(out.row);
    }
  }
  return r;
}

}  // namespace titop::modes
