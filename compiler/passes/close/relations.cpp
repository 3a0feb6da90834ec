#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/close/relations.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::passes::closing {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Role = Relations::Role;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

constexpr double kGoodPivot = 1e-3;

/// Row by row from the top, one pivot each; columns keep their places.
struct Elimination {
  MatrixXd M;
  std::vector<int> pivots = {};
  std::vector<char> taken = std::vector<char>(at(M.cols()), 0);
  double weakest = 1;

  double norm(int column) const {
    const auto done = static_cast<Index>(pivots.size());
    return M.col(column).tail(M.rows() - done).norm();
  }

  /// Takes pivots among these columns while they are above `least`; the largest that is left.
  double take(const std::vector<int>& columns, double least) {
    while (true) {
      if (static_cast<Index>(pivots.size()) == M.rows()) return 0;
      double largest = 0;
      for (const int c : columns)
        if (!taken[at(c)]) largest = std::max(largest, norm(c));
      if (!(largest > least)) return largest;
      for (const int c : columns)  // the first of equals: no choice by rounding
        if (!taken[at(c)] && norm(c) >= (1 - 1e-6) * largest) {
          reflect(c);
          break;
        }
      weakest = std::min(weakest, largest);
    }
  }

  void reflect(int column) {
    const auto k = static_cast<Index>(pivots.size());
    const Index n = M.rows() - k;
    VectorXd v = M.col(column).tail(n);
    const double alpha = v(0) > 0 ? -v.norm() : v.norm();
    pivots.push_back(column);
    taken[at(column)] = 1;
    if (v.tail(n - 1).isZero(0)) return;  // stands already: exact zeros stay
    v(0) -= alpha;
    v.normalize();
    for (Index j = 0; j < M.cols(); ++j) {
      const double along = v.dot(M.col(j).tail(n));
      if (along != 0) M.col(j).tail(n) -= 2 * along * v;
    }
    M.col(column).tail(n).setZero();
    M(k, column) = alpha;
  }
};

std::vector<int> columns_of(const Relations& r, Role role) {
  std::vector<int> list;
  for (std::size_t i = 0; i < r.role.size(); ++i)
    if (r.role[i] == role) list.push_back(static_cast<int>(i));
  return list;
}

}  // namespace

namespace {

/// Factors for rows (those of one number together) and for columns, each from what has its factor
/// already, so that none depends on units: columns that store energy begin; then come, in turn, the
/// rows that they reach, the columns that these reach, and so on.
struct Scaling {
  Relations& r;
  Factors f{VectorXd::Ones(r.R.rows()), VectorXd::Ones(r.R.cols())};
  std::vector<char> row_done = std::vector<char>(at(r.R.rows()), 0),
                    column_done = std::vector<char>(at(r.R.cols()), 0);

  std::vector<std::vector<Index>> rows_of = {};  ///< by number

  void start() {
    for (Index i = 0; i < r.R.rows(); ++i) {
      if (at(r.unit[at(i)]) >= rows_of.size()) rows_of.resize(at(r.unit[at(i)]) + 1);
      rows_of[at(r.unit[at(i)])].push_back(i);
    }
    for (Index j = 0; j < r.R.cols(); ++j)
      if (r.weight(j) > 0) scale_column(j, r.weight(j));
  }
  void scale_column(Index j, double factor) {
    f.column(j) = factor, r.R.col(j) *= factor;
    column_done[at(j)] = 1;
  }
  /// Rows of this number by their largest entry, in columns that are done or in all.
  bool rows(std::size_t unit, bool all) {
    double largest = 0;
    if (rows_of[unit].empty() || row_done[at(rows_of[unit].front())]) return false;
    for (const Index i : rows_of[unit])
      for (Index j = 0; j < r.R.cols(); ++j)
        if (all || column_done[at(j)]) largest = std::max(largest, std::abs(r.R(i, j)));
    if (largest == 0) return false;
    for (const Index i : rows_of[unit])
      f.row(i) = 1 / largest, r.R.row(i) /= largest, row_done[at(i)] = 1;
    return true;
  }
  bool columns() {
    bool any = false;
    for (Index j = 0; j < r.R.cols(); ++j) {
      if (column_done[at(j)]) continue;
      double largest = 0;
      for (Index i = 0; i < r.R.rows(); ++i)
        if (row_done[at(i)]) largest = std::max(largest, std::abs(r.R(i, j)));
      if (largest > 0) scale_column(j, 1 / largest), any = true;
    }
    return any;
  }
  void run() {
    start();
    for (bool more = true; more;) {
      more = false;
      for (std::size_t u = 0; u < rows_of.size(); ++u) more = rows(u, false) || more;
      more = columns() || more;
      for (std::size_t u = 0; u < rows_of.size() && !more; ++u) more = rows(u, true);
    }
  }
};

}  // namespace

Factors scale(Relations& relations) {
  Scaling scaling{relations};
  scaling.run();
  return std::move(scaling.f);
}

Independent independent(Relations r, const std::vector<int>& preferred) {
  Independent result;
  if (r.R.rows() == 0) return result;
  const VectorXd factor = scale(r).column;
  Elimination e{r.R};
  result.dropped = e.take(columns_of(r, Role::unknown), kRankTolerance);
  const std::size_t unknowns = e.pivots.size();
  std::vector<int> all = columns_of(r, Role::integral);
  std::vector<int> wanted;  // a preferred column may be an unknown by now
  for (const int c : preferred)
    if (r.role[at(c)] != Role::unknown) wanted.push_back(c);
  e.take(wanted, kGoodPivot);
  e.take(all, kGoodPivot);
  const std::vector<int> rest = columns_of(r, Role::coordinate);
  all.insert(all.end(), rest.begin(), rest.end());
  std::sort(all.begin(), all.end());
  result.dropped = std::max(result.dropped, e.take(all, kRankTolerance));
  result.weakest = e.weakest;
  result.dependent.assign(e.pivots.begin() + static_cast<std::ptrdiff_t>(unknowns), e.pivots.end());
  for (const int c : all)
    if (!e.taken[at(c)]) result.independent.push_back(c);
  const auto n = static_cast<Index>(result.dependent.size());
  const MatrixXd J = e.M.middleRows(static_cast<Index>(unknowns), n);
  MatrixXd T = -J(Eigen::all, result.independent);
  J(Eigen::all, result.dependent).eval().triangularView<Eigen::Upper>().solveInPlace(T);
  const double noise = 64 * 2.2e-16 * static_cast<double>(r.R.rows());
  for (Index i = 0; i < T.rows(); ++i)
    for (Index j = 0; j < T.cols(); ++j) {
      double& x = T(i, j);
      // Rounding between directions that have nothing to do with one another.
      x = std::abs(x) <= noise
              ? 0
              : x * factor(result.dependent[at(i)]) / factor(result.independent[at(j)]);
    }
  result.T = std::move(T);
  return result;
}

Redundant redundant(const MatrixXd& rows, MatrixXd& known) {
  Redundant result;
  if (rows.cols() == 0) {  // nothing moves at all
    result.directions = MatrixXd::Identity(rows.rows(), rows.rows());
    return result;
  }
  MatrixXd left = rows;
  for (int twice = 0; twice < 2; ++twice)
    if (known.cols() > 0) left -= (left * known) * known.transpose();
  const Eigen::JacobiSVD<MatrixXd> svd(left, Eigen::ComputeFullU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > kRankTolerance) ++rank;
  if (rank > 0) result.weakest = sigma(rank - 1);
  if (rank < sigma.size()) result.dropped = sigma(rank);
  const Index before = known.cols();
  known.conservativeResize(rows.cols(), before + rank);
  known.rightCols(rank) = svd.matrixV().leftCols(rank);
  result.directions = svd.matrixU().rightCols(rows.rows() - rank).transpose();
  return result;
}

}  // namespace titop::passes::closing
