#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/strong_components.hpp>
#include <boost/pending/disjoint_sets.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <vector>

namespace titop::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Wanted: t(row) - t(col) = log2, or a number below by the same for all.
struct LogRatio {
  int row, col;
  double log2;
};

/// Least squares over all ratios, of least norm if they leave a freedom [Curtis, Reid 1972]. With
/// `level`, that number is found too.
VectorXd fit(const std::vector<LogRatio>& ratios, int n, bool level) {
  MatrixXd N = MatrixXd::Zero(n + 1, n + 1);
  VectorXd r = VectorXd::Zero(n + 1);
  for (const auto& [i, j, log2] : ratios) {
    N(i, i) += 1, N(j, j) += 1;
    N(i, j) -= 1, N(j, i) -= 1;
    r(i) += log2, r(j) -= log2;
    if (!level) continue;
    N(i, n) += 1, N(n, i) += 1;
    N(j, n) -= 1, N(n, j) -= 1;
    N(n, n) += 1;
    r(n) += log2;
  }
  constexpr double kLeftOpen = 1e-9;  // far below the softest chain of ratios, n^-2
  N.diagonal().array() += kLeftOpen * std::max(1.0, N.diagonal().maxCoeff());
  return Eigen::LLT<MatrixXd>(N).solve(r).head(n);
}

double power_of_two(double log2) { return std::exp2(std::round(log2)); }

void scale(MatrixXd& A, VectorXd& d, Index i, double factor) {
  A.col(i) *= factor;
  A.row(i) /= factor;
  d(i) *= factor;
}

/// Least-squares fit to the logarithms of all entries that are not 0, for sizes far apart; entries
/// at rounding level count like others.
VectorXd by_logarithms(MatrixXd& A) {
  std::vector<LogRatio> ratios;
  for (int j = 0; j < A.cols(); ++j)
    for (int i = 0; i < A.rows(); ++i)
      if (i != j && A(i, j) != 0) ratios.push_back({i, j, std::log2(std::abs(A(i, j)))});
  const VectorXd t = fit(ratios, static_cast<int>(A.rows()), /*level=*/true);
  VectorXd d = VectorXd::Ones(A.rows());
  for (Index i = 0; i < A.rows(); ++i) scale(A, d, i, power_of_two(t(i)));
  return d;
}

/// Makes the 1-norms of each state's row and column equal in turn, until their sums decrease by
/// less than 5 percent, in at most 20 sweeps.
void sweep(MatrixXd& A, VectorXd& d) {
  constexpr int kSweeps = 20;
  constexpr double kGains = 0.95;  // of the sums: a factor of 2 that decreases them less is none
  for (int k = 0; k < kSweeps; ++k) {
    bool changed = false;
    for (Index i = 0; i < A.rows(); ++i) {
      const double own = std::abs(A(i, i)), column = A.col(i).cwiseAbs().sum() - own,
                   row = A.row(i).cwiseAbs().sum() - own;
      if (!(column > 0 && row > 0)) continue;
      const double f = power_of_two(std::log2(row / column) / 2);
      if (column * f + row / f >= kGains * (column + row)) continue;
      scale(A, d, i, f);
      changed = true;
    }
    if (!changed) return;
  }
}

/// The scales of one part: by logarithms, unless rounding among the entries has led them astray.
VectorXd within(const MatrixXd& part) {
  MatrixXd one = part, other = part;
  VectorXd d_one = VectorXd::Ones(part.rows()), d_other = by_logarithms(other);
  sweep(one, d_one);
  sweep(other, d_other);
  constexpr double kAsGood = 1.25;
  return other.cwiseAbs().sum() <= kAsGood * one.cwiseAbs().sum() ? d_other : d_one;
}

/// Of the largest entry of all parts: a part whose entries are smaller may be rounding alone, and
/// counts as 0.
constexpr double kOwn = 16 * kEpsilon;

/// Makes the largest entry between two parts as large as the largest within either; within parts
/// that are 0, as the largest of all.
void fit_between(MatrixXd& A, VectorXd& d, const std::vector<std::vector<int>>& parts) {
  const int count = static_cast<int>(parts.size());
  std::vector<int> part(at(A.rows()));
  for (int p = 0; p < count; ++p)
    for (const int i : parts[at(p)]) part[at(i)] = p;
  MatrixXd largest = MatrixXd::Zero(count, count);
  for (int j = 0; j < A.cols(); ++j)
    for (int i = 0; i < A.rows(); ++i) {
      double& most = largest(part[at(i)], part[at(j)]);
      most = std::max(most, std::abs(A(i, j)));
    }
  const double most = largest.diagonal().maxCoeff();
  const auto size = [&](int i, int j) {
    const double within = std::max(largest(i, i), largest(j, j));
    return within > kOwn * most ? within : most > 0 ? most : 1;
  };
  std::vector<LogRatio> ratios;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      if (i != j && largest(i, j) > 0)
        ratios.push_back({i, j, std::log2(largest(i, j) / size(i, j))});
  if (ratios.empty()) return;
  const VectorXd t = fit(ratios, count, /*level=*/most == 0);
  for (int i = 0; i < A.rows(); ++i) scale(A, d, i, power_of_two(t(part[at(i)])));
}

/// The states of each part, by the part of each state.
std::vector<std::vector<int>> sets_of(const std::vector<int>& part) {
  std::vector<std::vector<int>> result;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (at(part[i]) >= result.size()) result.resize(at(part[i]) + 1);
    result[at(part[i])].push_back(static_cast<int>(i));
  }
  return result;
}

}  // namespace

VectorXd similarity_scaling(MatrixXd& A) {
  VectorXd d = VectorXd::Ones(A.rows());
  if (A.allFinite()) sweep(A, d);
  return d;
}

VectorXd similarity_scaling_of_parts(MatrixXd& A) {
  VectorXd d = VectorXd::Ones(A.rows());
  if (!A.allFinite()) return d;
  const std::vector<std::vector<int>> sets = parts(A);
  for (const std::vector<int>& part : sets) {
    if (part.size() < 2) continue;
    const VectorXd of_part = within(A(part, part));
    for (std::size_t i = 0; i < part.size(); ++i)
      scale(A, d, part[i], of_part(static_cast<Index>(i)));
  }
  if (sets.size() > 1) fit_between(A, d, sets);
  return d;
}

TwoSidedScaling two_sided_scaling(const MatrixXd& M) {
  const int rows = static_cast<int>(M.rows()), columns = static_cast<int>(M.cols());
  std::vector<LogRatio> ratios;
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i)
      if (M(i, j) != 0) ratios.push_back({i, rows + j, std::log2(std::abs(M(i, j)))});
  TwoSidedScaling result{VectorXd::Ones(rows), VectorXd::Ones(columns)};
  if (ratios.empty()) return result;
  const VectorXd t = fit(ratios, rows + columns, /*level=*/false);
  for (int i = 0; i < rows; ++i) result.row(i) = power_of_two(-t(i));
  for (int j = 0; j < columns; ++j) result.column(j) = power_of_two(t(rows + j));
  return result;
}

std::vector<std::vector<int>> parts(const MatrixXd& A) {
  boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS> acts(at(A.rows()));
  for (int j = 0; j < A.cols(); ++j)
    for (int i = 0; i < A.rows(); ++i)
      if (i != j && A(i, j) != 0) boost::add_edge(at(j), at(i), acts);
  std::vector<int> part(at(A.rows()));
  boost::strong_components(
      acts, boost::make_iterator_property_map(part.begin(), get(boost::vertex_index, acts)));
  return sets_of(part);
}

std::vector<std::vector<int>> uncoupled_parts(const MatrixXd& A) {
  const auto n = static_cast<int>(A.rows());
  std::vector<std::size_t> rank(at(n)), parent(at(n));
  const boost::typed_identity_property_map<std::size_t> places;
  boost::disjoint_sets joined(boost::make_iterator_property_map(rank.begin(), places),
                              boost::make_iterator_property_map(parent.begin(), places));
  for (int i = 0; i < n; ++i) joined.make_set(at(i));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      if (i != j && A(i, j) != 0) joined.union_set(at(i), at(j));
  std::vector<int> part(at(n)), number(at(n), -1);
  int count = 0;
  for (int i = 0; i < n; ++i) {
    int& own = number[joined.find_set(at(i))];
    if (own < 0) own = count++;
    part[at(i)] = own;
  }
  return sets_of(part);
}

}  // namespace titop::linalg
