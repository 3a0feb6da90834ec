#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// First column of each variable in a front: pivots first, then the border.
std::vector<std::pair<int, int>> columns_of(const Front& f, const Plan& plan) {
  std::vector<std::pair<int, int>> result;  // (variable, column), sorted by variable
  int column = 0;
  for (const auto* list : {&f.pivots, &f.border})
    for (const int v : *list) {
      result.emplace_back(v, column);
      column += plan.structure.variable_size[at(v)];
    }
  std::sort(result.begin(), result.end());
  return result;
}

int column(const std::vector<std::pair<int, int>>& columns, int variable) {
  return std::lower_bound(columns.begin(), columns.end(), std::pair(variable, 0))->second;
}

template <class T>
double size_of(const T& x) {
  using std::abs;
  return static_cast<double>(abs(x));
}

/// Brings rows and columns towards a largest entry of 1, in place [Ruiz 2001]; each round halves
/// the decades that units have put between them. Returns the columns' factors.
Eigen::VectorXd equilibrate(Eigen::MatrixXd& A) {
  const auto factor = [](double largest) {
    return largest > 0 && std::isfinite(largest) ? 1 / std::sqrt(largest) : 1.0;
  };
  Eigen::VectorXd c = Eigen::VectorXd::Ones(A.cols());
  for (int round = 0; round < 6; ++round) {
    const Eigen::VectorXd row = A.rowwise().maxCoeff().unaryExpr(factor);
    const Eigen::VectorXd col = A.colwise().maxCoeff().transpose().unaryExpr(factor);
    A = row.asDiagonal() * A * col.asDiagonal();
    c = c.cwiseProduct(col);
  }
  return c;
}

/// Factors that give the columns the same size whatever the units: means of binary exponents over
/// the entries, rows and columns in turn [Curtis, Reid 1972]. Entries that equilibration leaves
/// below 1e-13 are rounding (a rotation by pi) and do not count: they would draw the means along.
Eigen::VectorXd column_scale(const Eigen::MatrixXd& bound) {
  Eigen::MatrixXd scaled = bound;
  Eigen::VectorXd result = equilibrate(scaled);
  const Eigen::MatrixXd exponent =
      scaled.unaryExpr([](double x) { return x > 1e-13 ? std::log2(x) : std::nan(""); });
  Eigen::VectorXd r = Eigen::VectorXd::Zero(bound.rows()), c = Eigen::VectorXd::Zero(bound.cols());
  const auto mean = [](const auto& values, const auto& other) {
    double sum = 0, count = 0;
    for (Eigen::Index i = 0; i < values.size(); ++i)
      if (!std::isnan(values(i))) sum += values(i) + other(i), ++count;
    return count > 0 ? sum / count : 0;
  };
  for (int round = 0; round < 4; ++round) {
    for (Eigen::Index i = 0; i < r.size(); ++i) r(i) = -mean(exponent.row(i), c);
    for (Eigen::Index j = 0; j < c.size(); ++j) c(j) = -mean(exponent.col(j), r);
  }
  for (Eigen::Index j = 0; j < c.size(); ++j)
    result(j) = std::exp2(std::round(std::log2(result(j)) + c(j)));
  return result;
}

/// Largest share that cancellation has left of a row's last `count` entries; 1 unless it is little:
/// ordinary losses are not to add up along a long chain.
template <class Row, class Bound>
double kept(const Row& row, const Bound& bound, Eigen::Index count) {
  double largest = 0;
  for (Eigen::Index j = row.size() - count; j < row.size(); ++j)
    if (bound(j) > 0) largest = std::max(largest, size_of(row(j)) / bound(j));
  return largest > 1e-6 || largest == 0 ? 1 : largest;
}

}  // namespace

template <class T>
Factors<T>::Factors(const Plan& plan, const std::vector<RowEntries<T>>& entries) : plan_(&plan) {
  std::vector<LeftOver> left_over(plan.fronts.size());
  fronts_.resize(plan.fronts.size());
  for (std::size_t i = 0; i < plan.fronts.size(); ++i) {
    const Front& front = plan.fronts[i];
    Eigen::VectorXd keeps = Eigen::VectorXd::Ones(front.row_count);
    fronts_[i].lu = assemble(front, entries, left_over, keeps);
    eliminate(front, fronts_[i], keeps);
    if (health_.singular) return;
    const int rest = front.row_count - front.pivot_count;
    left_over[i] = {fronts_[i].lu.bottomRightCorner(rest, front.border_count), keeps.tail(rest)};
  }
}

template <class T>
typename Factors<T>::Matrix Factors<T>::assemble(const Front& front,
                                                 const std::vector<RowEntries<T>>& entries,
                                                 std::vector<LeftOver>& left_over,
                                                 Eigen::VectorXd& keeps) const {
  const auto columns = columns_of(front, *plan_);
  Matrix F = Matrix::Zero(front.row_count, front.pivot_count + front.border_count);
  Eigen::Index row = 0;
  for (const int r : front.rows) {
    const auto& variables = plan_->structure.variables[at(r)];
    for (std::size_t k = 0; k < variables.size(); ++k) {
      const auto& block = entries[at(r)][k];
      F.block(row, column(columns, variables[k]), block.rows(), block.cols()) = block;
    }
    row += plan_->structure.row_size[at(r)];
  }
  for (const int child : front.children) {
    Matrix& rest = left_over[at(child)].rows;
    keeps.segment(row, rest.rows()) = left_over[at(child)].keeps;
    Eigen::Index from = 0;
    for (const int v : plan_->fronts[at(child)].border) {
      const int size = plan_->structure.variable_size[at(v)];
      F.block(row, column(columns, v), rest.rows(), size) = rest.middleCols(from, size);
      from += size;
    }
    row += rest.rows();
    rest.resize(0, 0);
  }
  return F;
}

template <class T>
void Factors<T>::note_weakest(const Front& front, int column, double left) {
  if (!(left < health_.weakest)) return;
  health_.weakest = left;
  int end = 0;
  for (const int v : front.pivots) {
    end += plan_->structure.variable_size[at(v)];
    if (end <= column) continue;
    health_.weakest_variable = v;
    return;
  }
}

/// LU of the pivot columns. The pivot of a column is the row where it stands out most against the
/// row's own size, the columns having been given the same size: the choice depends neither on the
/// rows' units nor on the columns'. `bound` carries the sums of magnitudes that formed each entry:
/// a pivot far below its bound is what cancellation has left. `keeps` says so of whole rows, from
/// front to front: a row of which only rounding is left must not pass for a good one further up.
template <class T>
void Factors<T>::eliminate(const Front& front, Factored& f, Eigen::VectorXd& keeps) {
  Matrix& A = f.lu;
  const int rows = front.row_count, pivots = front.pivot_count;
  f.order.resize(at(rows));
  for (int i = 0; i < rows; ++i) f.order[at(i)] = i;
  Eigen::MatrixXd bound =
      A.unaryExpr([](const T& x) { return size_of(x); }).template cast<double>();
  const double start = bound.size() ? bound.maxCoeff() : 0;
  bound = keeps.cwiseInverse().asDiagonal() * bound;
  Eigen::VectorXd scale = (bound * column_scale(bound).asDiagonal()).rowwise().maxCoeff();
  for (int k = 0; k < pivots; ++k) {
    int best = -1;
    double best_score = 0, left = 0;
    for (int i = k; i < rows; ++i) {
      const double score = scale(i) > 0 ? size_of(A(i, k)) / scale(i) : 0;
      if (score > best_score) best_score = score, best = i;
      // What a column keeps after cancellation, over all its rows: invariant under any scaling.
      if (bound(i, k) > 0) left = std::max(left, size_of(A(i, k)) / bound(i, k));
    }
    note_weakest(front, k, left);
    if (best < 0 || left < 4 * std::numeric_limits<double>::epsilon() ||
        !std::isfinite(best_score)) {
      health_.singular = true;
      health_.singular_variables = front.pivots;
      return;
    }
    if (best != k) {
      A.row(best).swap(A.row(k));
      bound.row(best).swap(bound.row(k));
      std::swap(scale(best), scale(k));
      std::swap(f.order[at(best)], f.order[at(k)]);
    }
    const Eigen::Index right = A.cols() - k - 1;
    for (int i = k + 1; i < rows; ++i) {
      if (A(i, k) == T(0)) continue;
      const T l = A(i, k) / A(k, k);
      A(i, k) = l;
      A.row(i).tail(right) -= l * A.row(k).tail(right);
      bound.row(i).tail(right) += size_of(l) * bound.row(k).tail(right);
    }
  }
  for (int i = pivots; i < rows; ++i) keeps(i) = kept(A.row(i), bound.row(i), front.border_count);
  if (start > 0) {
    const double end =
        A.unaryExpr([](const T& x) { return size_of(x); }).template cast<double>().maxCoeff();
    health_.growth = std::max(health_.growth, end / start);
  }
}

template <class T>
typename Factors<T>::Matrix Factors<T>::solve(const std::vector<Matrix>& rhs,
                                              Eigen::Index columns) const {
  std::vector<Matrix> y(fronts_.size()), left_over(fronts_.size());
  for (std::size_t i = 0; i < fronts_.size(); ++i) {
    const Front& front = plan_->fronts[i];
    const Matrix& lu = fronts_[i].lu;
    Matrix b = Matrix::Zero(front.row_count, columns);
    Eigen::Index row = 0;
    for (const int r : front.rows) {
      const int size = plan_->structure.row_size[at(r)];
      if (rhs[at(r)].size()) b.middleRows(row, size) = rhs[at(r)];
      row += size;
    }
    for (const int child : front.children) {
      b.middleRows(row, left_over[at(child)].rows()) = left_over[at(child)];
      row += left_over[at(child)].rows();
      left_over[at(child)].resize(0, 0);
    }
    Matrix p(b.rows(), columns);
    for (int k = 0; k < front.row_count; ++k) p.row(k) = b.row(fronts_[i].order[at(k)]);
    const int n = front.pivot_count, rest = front.row_count - n;
    lu.topLeftCorner(n, n).template triangularView<Eigen::UnitLower>().solveInPlace(p.topRows(n));
    if (rest > 0) p.bottomRows(rest).noalias() -= lu.bottomLeftCorner(rest, n) * p.topRows(n);
    left_over[i] = p.bottomRows(rest);
    y[i] = p.topRows(n);
  }
  Matrix z(plan_->unknowns, columns);
  for (std::size_t i = fronts_.size(); i-- > 0;) {
    const Front& front = plan_->fronts[i];
    const Matrix& lu = fronts_[i].lu;
    const int n = front.pivot_count;
    Eigen::Index from = n;
    for (const int v : front.border) {
      const int size = plan_->structure.variable_size[at(v)];
      y[i].noalias() -= lu.block(0, from, n, size) * z.middleRows(plan_->first[at(v)], size);
      from += size;
    }
    lu.topLeftCorner(n, n).template triangularView<Eigen::Upper>().solveInPlace(y[i]);
    Eigen::Index row = 0;
    for (const int v : front.pivots) {
      const int size = plan_->structure.variable_size[at(v)];
      z.middleRows(plan_->first[at(v)], size) = y[i].middleRows(row, size);
      row += size;
    }
    y[i].resize(0, 0);
  }
  return z;
}

template class Factors<double>;
template class Factors<std::complex<double>>;

}  // namespace titop::solve
