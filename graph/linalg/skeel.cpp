#include <Eigen/SparseCore>
#include <algorithm>
#include <bitset>
#include <boost/container/small_vector.hpp>
#include <boost/dynamic_bitset.hpp>
#include <cmath>
#include <titop/graph/linalg/skeel.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::linalg {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kSmall = 12;
/// Small loops are many: no memory is asked for.
using Small =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kSmall, kSmall>;

/// From M^k, k = 1, 2, 4 ... 1024: the row sums v of M^k give max (M v)_i / v_i, never below the
/// radius [Collatz 1942]; where that stays loose, |M^1024|^(1/1024), the norm's own factor n having
/// become n^(1/1024).
double perron_by_squaring(const Small& M) {
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSmall, 1>;
  Small power = M;
  double log_scale = 0, weight = 1;
  for (int step = 0; step <= 10; ++step, weight /= 2) {
    const Column v = power.rowwise().sum();
    const double size = v.maxCoeff();
    if (!(size > 0)) return 0;
    if (v.minCoeff() > 0) {
      const Column grown = M.lazyProduct(v).cwiseQuotient(v);
      if (grown.maxCoeff() - grown.minCoeff() <= 1e-3 * grown.maxCoeff()) return grown.maxCoeff();
    }
    log_scale += weight * std::log(size);
    if (step == 10) break;
    power /= size;
    power = power.lazyProduct(power).eval();
  }
  return std::exp(log_scale);
}

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What power iteration finds.
struct Powers {
  double radius = 0;     ///< from above
  bool settled = false;  ///< known to 1e-3
};

/// Power iteration [Collatz 1942]; `times`: M v. |M^-1| |M| has a diagonal of 1 and more: nothing
/// oscillates.
template <class Times>
Powers perron_by_powers(Eigen::Index n, int steps, Times times) {
  VectorXd v = VectorXd::Ones(n), w, grown;
  for (int step = 0; step < steps; ++step) {
    w = times(v);
    grown = w.cwiseQuotient(v);
    const double most = grown.maxCoeff();
    if (most - grown.minCoeff() <= 1e-3 * most) return {most, true};
    v = (w / w.maxCoeff()).cwiseMax(1e-300);
  }
  return {grown.maxCoeff(), false};
}

double perron(const Small& M) { return perron_by_squaring(M); }
double perron(const RowMatrix& M) {
  return perron_by_powers(M.rows(), 200, [&](const VectorXd& v) -> VectorXd { return M * v; })
      .radius;
}

/// Spectral radius of M: the largest of its irreducible diagonal blocks. Loops that a zero
/// coefficient cuts open have rows that reach each other one way only; on them no power converges.
/// Set: of as many bits as rows, `none` empty.
template <class Rows, class Set>
double perron_of_parts(const Rows& M, const Set& none) {
  const auto n = static_cast<std::size_t>(M.rows());
  const auto entry = [&](std::size_t i, std::size_t j) {
    return M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  };
  boost::container::small_vector<Set, kSmall> reach(n, none);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (i == j || entry(i, j) != 0) reach[i].set(j);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      if (reach[i].test(k)) reach[i] |= reach[k];
  double radius = 0;
  Set done = none;
  boost::container::small_vector<Eigen::Index, kSmall> members;
  for (std::size_t i = 0; i < n; ++i) {
    if (done.test(i)) continue;
    members.clear();
    for (std::size_t j = i; j < n; ++j)
      if (reach[i].test(j) && reach[j].test(i))
        members.push_back(static_cast<Eigen::Index>(j)), done.set(j);
    radius =
        std::max(radius, members.size() == 1 ? entry(i, i) : perron(Rows(M(members, members))));
  }
  return radius;
}

/// y -= a x, n entries.
TITOP_WIDE void subtract(Eigen::Index n, double a, const double* x, double* y) {
  for (Eigen::Index i = 0; i < n; ++i) y[i] -= a * x[i];
}

TITOP_WIDE Eigen::Index nonzeros(Eigen::Index n, const double* x) {
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < n; ++i) count += x[i] != 0;
  return count;
}

/// Row of the pivot of column k: one with few entries among those that are large enough there. k -
/// 1 if all are 0.
template <class Rows>
Eigen::Index sparse_pivot(const Rows& M, Eigen::Index k) {
  double largest = 0;
  for (Eigen::Index i = k; i < M.rows(); ++i) largest = std::max(largest, std::abs(M(i, k)));
  Eigen::Index best = k - 1, fewest = M.rows() + 1;
  for (Eigen::Index i = k; i < M.rows(); ++i) {
    if (M(i, k) == 0 || std::abs(M(i, k)) < 0.1 * largest) continue;
    const Eigen::Index entries = nonzeros(M.cols() - k, &M(i, k));
    if (entries < fewest) fewest = entries, best = i;
  }
  return best;
}

/// M^-1 by elimination row by row: most entries of a loop are 0, and what is 0 costs nothing. 0 x 0
/// if a pivot is 0.
template <class Rows>
Rows inverse_by_rows(Rows M) {
  const auto n = M.rows();
  Rows X = Rows::Identity(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index best = sparse_pivot(M, k);
    if (best < k) return Rows(0, 0);
    if (best != k) {
      M.row(k).swap(M.row(best));
      X.row(k).swap(X.row(best));
    }
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (M(i, k) == 0) continue;
      const double factor = M(i, k) / M(k, k);
      subtract(n - k - 1, factor, &M(k, k) + 1, &M(i, k) + 1);
      subtract(n, factor, &X(k, 0), &X(i, 0));
    }
  }
  for (Eigen::Index i = n; i-- > 0;) {
    for (Eigen::Index k = i + 1; k < n; ++k)
      if (M(i, k) != 0) subtract(n, M(i, k), &X(k, 0), &X(i, 0));
    X.row(i) /= M(i, i);
  }
  return X;
}

/// |a| |b|; most entries are 0.
RowMatrix product_of_sizes(const RowMatrix& a, const RowMatrix& b) {
  RowMatrix result = RowMatrix::Zero(a.rows(), b.cols());
  const RowMatrix sizes = b.cwiseAbs();
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index k = 0; k < a.cols(); ++k)
      if (a(i, k) != 0) subtract(b.cols(), -std::abs(a(i, k)), &sizes(k, 0), &result(i, 0));
  return result;
}

/// Peels off rows and columns with a single entry, again and again: M is block triangular, and what
/// goes stands on its diagonal by itself, where the radius is 1.
class Peeled {
 public:
  using List = boost::container::small_vector<Eigen::Index, kSmall>;

  explicit Peeled(const MatrixXd& M) : M_(M), in_row_(at(M.rows())), in_col_(at(M.rows())) {
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      for (Eigen::Index i = 0; i < M.rows(); ++i)
        if (M(i, j) != 0) ++in_row_[at(i)], ++in_col_[at(j)];
    for (bool more = true; more;) {
      more = false;
      for (Eigen::Index i = 0; i < M.rows(); ++i)
        if (in_row_[at(i)] == 1) more = take(i, column_of(i));
      for (Eigen::Index j = 0; j < M.cols(); ++j)
        if (in_col_[at(j)] == 1) more = take(row_of(j), j);
    }
  }
  /// Nothing is left in some row or column.
  bool singular() const {
    return std::count(in_row_.begin(), in_row_.end(), 0) > 0 ||
           std::count(in_col_.begin(), in_col_.end(), 0) > 0;
  }
  bool whole() const { return taken_ == 0; }
  List rows() const { return left(in_row_); }
  List cols() const { return left(in_col_); }

 private:
  static constexpr int kTaken = -1;
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  Eigen::Index column_of(Eigen::Index row) const {
    Eigen::Index j = 0;
    while (in_col_[at(j)] == kTaken || M_(row, j) == 0) ++j;
    return j;
  }
  Eigen::Index row_of(Eigen::Index column) const {
    Eigen::Index i = 0;
    while (in_row_[at(i)] == kTaken || M_(i, column) == 0) ++i;
    return i;
  }
  bool take(Eigen::Index row, Eigen::Index column) {
    in_row_[at(row)] = in_col_[at(column)] = kTaken;
    for (Eigen::Index i = 0; i < M_.rows(); ++i)
      if (in_row_[at(i)] != kTaken && M_(i, column) != 0) --in_row_[at(i)];
    for (Eigen::Index j = 0; j < M_.cols(); ++j)
      if (in_col_[at(j)] != kTaken && M_(row, j) != 0) --in_col_[at(j)];
    ++taken_;
    return true;
  }
  using Counts = boost::container::small_vector<int, kSmall>;
  static List left(const Counts& counts) {
    List list;
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] != kTaken) list.push_back(static_cast<Eigen::Index>(i));
    return list;
  }

  const MatrixXd& M_;
  Counts in_row_, in_col_;
  int taken_ = 0;
};

/// [a, b; c, d]: (1 + sqrt|t|)^2 / |1 - t|, t = bc/ad or its inverse, whichever is below 1.
double skeel_radius_of_two(const MatrixXd& M) {
  const bool diagonal = M(0, 0) != 0 && M(1, 1) != 0;
  double t = diagonal ? (M(0, 1) / M(0, 0)) * (M(1, 0) / M(1, 1)) : 2;
  if (!(std::abs(t) <= 1)) {
    if (M(0, 1) == 0 || M(1, 0) == 0) return 0;
    t = (M(0, 0) / M(0, 1)) * (M(1, 1) / M(1, 0));
  }
  const double sum = 1 + std::sqrt(std::abs(t));
  return t == 1 ? 0 : sum * sum / std::abs(1 - t);
}

double skeel_radius_of_core(const MatrixXd& M) {
  if (M.rows() == 2) return skeel_radius_of_two(M);
  if (M.rows() > kSmall) {
    const RowMatrix inverse = inverse_by_rows<RowMatrix>(M);
    if (inverse.size() == 0) return 0;
    constexpr int kWhole = 25;  // where they do not settle by then, mostly the loop is cut open
    const RowMatrix of_inverse = inverse.cwiseAbs();
    const Eigen::SparseMatrix<double, Eigen::RowMajor> of_M = M.cwiseAbs().sparseView();
    const Powers whole = perron_by_powers(M.rows(), kWhole, [&](const VectorXd& v) -> VectorXd {
      return of_inverse * VectorXd(of_M * v);
    });
    if (whole.settled) return whole.radius;
    return perron_of_parts(product_of_sizes(inverse, M),
                           boost::dynamic_bitset<>(static_cast<std::size_t>(M.rows())));
  }
  const Small inverse = inverse_by_rows<Small>(M);
  if (inverse.size() == 0) return 0;
  return perron_of_parts<Small>(inverse.cwiseAbs().lazyProduct(M.cwiseAbs()),
                                std::bitset<kSmall>());
}

}  // namespace

double skeel_radius(const MatrixXd& M) {
  if (M.rows() == 2) return skeel_radius_of_two(M);
  const Peeled peeled(M);
  if (peeled.singular()) return 0;
  if (peeled.whole()) return skeel_radius_of_core(M);
  const auto rows = peeled.rows();
  return rows.empty() ? 1 : skeel_radius_of_core(M(rows, peeled.cols()));
}

}  // namespace titop::linalg
