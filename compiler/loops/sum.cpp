#include <algorithm>
#include <titop/compiler/loops/sum.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;
using linalg::kEpsilon;

constexpr double kUnits = 32;     ///< of rounding in a product of any two matrices of six
constexpr double kUnitsEach = 2;  ///< more with every factor: rounding of a product of six sums

/// 0 for translations, 1 for rotations, of six.
std::size_t half(Index i, Index count) { return count == 6 && i >= 3 ? 1 : 0; }

}  // namespace

std::vector<int> units_of_rows(const MatrixXd& S) {
  std::vector<int> units;
  for (Index i = 0; i < S.rows(); ++i)
    units.push_back(S.cols() == 6 && S.row(i).head(3).isZero(0) ? 1 : 0);
  return units;
}

void RoundedSum::meet(const MatrixXd& factor) {
  ++factors_;
  for (Index j = 0; j < factor.cols(); ++j)
    for (Index i = 0; i < factor.rows(); ++i) {
      auto& most = most_[at(units_[at(i)])];
      const double size = std::abs(factor(i, j));
      most[half(j, factor.cols())] = std::max(most[half(j, factor.cols())], size);
      if (factor.cols() != 6) {
        most[1] = std::max(most[1], size);
        continue;
      }
      double& of_six = of_six_[at(units_[at(i)])][half(j, 6)];
      of_six = std::max(of_six, size);
    }
}

void RoundedSum::add(const MatrixXd& factor, const Form& own) {
  const double units = (kUnits + kUnitsEach * factors_) * kEpsilon;
  for (const auto& [column, matrix] : own) {
    loops::add(form_, column, factor * matrix);
    MatrixXd rounding(factor.rows(), matrix.cols());
    for (Index j = 0; j < matrix.cols(); ++j) {
      std::array<double, 2> size = {};
      for (Index k = 0; k < matrix.rows(); ++k) {
        double& s = size[half(k, matrix.rows())];
        s = std::max(s, std::abs(matrix(k, j)));
      }
      for (Index i = 0; i < factor.rows(); ++i) {
        const auto& most = most_[at(units_[at(i)])];
        rounding(i, j) = units * (most[0] * size[0] + most[1] * size[1]);
      }
    }
    loops::add(rounding_, column, rounding);
  }
}

Form RoundedSum::cleaned() const {
  Form result;
  for (const auto& [column, matrix] : form_) {
    MatrixXd m = (matrix.array().abs() <= rounding_.at(column).array()).select(0.0, matrix);
    if (!m.isZero(0)) result.emplace(column, std::move(m));
  }
  return result;
}

}  // namespace titop::loops
