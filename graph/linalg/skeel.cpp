#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <titop/graph/linalg/skeel.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::linalg {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kSmall = 12;
constexpr int kMost = 128;  ///< rows: two words of bits
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

/// A product of quotients that may overflow on the way: value * 2^exponent.
struct Quotient {
  double value = 1;
  int exponent = 0;

  void multiply(double numerator, double denominator) {
    if (const double q = numerator / denominator; is_usual(q)) {
      value *= q;
    } else {
      int up = 0, down = 0;
      value *= std::frexp(numerator, &up) / std::frexp(denominator, &down);
      exponent += up - down;
    }
    if (is_usual(value)) return;
    int e = 0;
    value = std::frexp(value, &e);
    exponent += e;
  }
  static bool is_usual(double x) { return std::abs(x) > 1e-150 && std::abs(x) < 1e150; }
};

/// p and 1/p belong to the same ring, turned round.
double skeel_radius_of_ring(Eigen::Index n, const Quotient& product) {
  double p = std::ldexp(product.value, product.exponent);
  if (std::abs(p) > 1) p = std::ldexp(1 / product.value, -product.exponent);
  const double c = std::pow(std::abs(p), 1 / static_cast<double>(n));
  double sum = 0;
  for (Eigen::Index k = 0; k < n; ++k) sum = 1 + c * sum;
  return p == 1 ? 0 : (1 + c) * sum / std::abs(1 - p);
}

/// Some of up to kMost rows or columns.
struct Set {
  std::array<std::uint64_t, 2> bits = {};

  static Set first(Eigen::Index n) {
    Set s;
    for (Eigen::Index i = 0; i < n; ++i) s.put(i);
    return s;
  }
  void put(Eigen::Index i) { bits[word(i)] |= bit(i); }
  void drop(Eigen::Index i) { bits[word(i)] &= ~bit(i); }
  bool has(Eigen::Index i) const { return bits[word(i)] & bit(i); }
  bool empty() const { return (bits[0] | bits[1]) == 0; }
  /// Exactly one; exactly two. Not by counting bits, for which old machines have no instruction.
  bool one() const { return !empty() && without_front().empty(); }
  bool two() const { return !empty() && without_front().one(); }
  /// The first, where there is one.
  Eigen::Index front() const {
    return bits[0] ? std::countr_zero(bits[0]) : 64 + std::countr_zero(bits[1]);
  }
  Set without_front() const {
    const std::uint64_t a = bits[0], b = bits[1];
    return a ? Set{{a & (a - 1), b}} : Set{{a, b & (b - 1)}};
  }
  /// Where there are two: the other one.
  Eigen::Index other_than(Eigen::Index i) const {
    Set s = *this;
    s.drop(i);
    return s.front();
  }
  friend Set operator&(const Set& a, const Set& b) {
    return {{a.bits[0] & b.bits[0], a.bits[1] & b.bits[1]}};
  }

 private:
  static std::size_t word(Eigen::Index i) { return static_cast<std::size_t>(i) / 64; }
  static std::uint64_t bit(Eigen::Index i) { return std::uint64_t{1} << (i % 64); }
};

/// Peels off rows and columns with a single entry, again and again: M is block triangular, and what
/// goes stands on its diagonal by itself, where the radius is 1.
class Peeled {
 public:
  using List = boost::container::small_vector<Eigen::Index, kSmall>;

  explicit Peeled(const MatrixXd& M)
      : M_(M),
        n_(M.rows()),
        left_(n_),
        in_row_(static_cast<std::size_t>(n_)),
        in_col_(static_cast<std::size_t>(n_)),
        rows_(Set::first(n_)),
        cols_(rows_) {
    const double* entry = M.data();
    for (Eigen::Index j = 0; j < n_; ++j)
      for (Eigen::Index i = 0; i < n_; ++i)
        if (*entry++ != 0) of(in_row_, i).put(j), of(in_col_, j).put(i);
    for (bool more = true; more;) {
      more = false;
      for (Eigen::Index i = 0; i < n_; ++i)
        if (rows_.has(i) && row(i).one()) more = take(i, row(i).front());
      for (Eigen::Index j = 0; j < n_; ++j)
        if (cols_.has(j) && col(j).one()) more = take(col(j).front(), j);
    }
  }
  /// Nothing is left in some row or column.
  bool singular() const {
    for (Eigen::Index i = 0; i < n_; ++i)
      if ((rows_.has(i) && row(i).empty()) || (cols_.has(i) && col(i).empty())) return true;
    return false;
  }
  bool whole() const { return left_ == n_; }
  bool empty() const { return left_ == 0; }
  List rows() const { return list(rows_); }
  List cols() const { return list(cols_); }

  /// Of what is left, if that is one ring, in which every unknown stands in its own row and in the
  /// next one's only: (1 + c)(1 + c + ... + c^(n-1)) / |1 - p|, p the product of the n gains and c
  /// = |p|^(1/n). Others: nothing.
  std::optional<double> radius_of_ring() const {
    for (Eigen::Index i = 0; i < n_; ++i)
      if ((rows_.has(i) && !row(i).two()) || (cols_.has(i) && !col(i).two())) return {};
    // Along the ring: from a row's own entry to its other one, and up or down to the next row.
    const Eigen::Index start = rows_.front();
    Eigen::Index i = start, own = row(start).front(), n = 0;
    Quotient product;
    do {
      const Eigen::Index next = row(i).other_than(own);
      product.multiply(-M_(i, next), M_(i, own));
      i = col(next).other_than(i), own = next, ++n;
    } while (i != start);
    if (n != left_) return {};  // several rings
    return skeel_radius_of_ring(n, product);
  }

 private:
  using Sets = boost::container::small_vector<Set, kSmall>;

  static Set& of(Sets& sets, Eigen::Index i) { return sets[static_cast<std::size_t>(i)]; }
  Set row(Eigen::Index i) const { return in_row_[static_cast<std::size_t>(i)] & cols_; }
  Set col(Eigen::Index j) const { return in_col_[static_cast<std::size_t>(j)] & rows_; }
  bool take(Eigen::Index i, Eigen::Index j) {
    rows_.drop(i);
    cols_.drop(j);
    --left_;
    return true;
  }
  List list(const Set& set) const {
    List result;
    for (Eigen::Index i = 0; i < n_; ++i)
      if (set.has(i)) result.push_back(i);
    return result;
  }

  const MatrixXd& M_;
  Eigen::Index n_, left_;
  Sets in_row_, in_col_;  ///< entries
  Set rows_, cols_;       ///< that are left
};

double skeel_radius_of_core(const MatrixXd& M) {
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
    return perron_of_parts(product_of_sizes(inverse, M), std::bitset<kMost>());
  }
  const Small inverse = inverse_by_rows<Small>(M);
  if (inverse.size() == 0) return 0;
  return perron_of_parts<Small>(inverse.cwiseAbs().lazyProduct(M.cwiseAbs()),
                                std::bitset<kSmall>());
}

}  // namespace

double skeel_radius(MatrixXd& M, const std::function<void(MatrixXd&)>& scale) {
  if (M.rows() != M.cols() || M.rows() > kMost)
    throw std::invalid_argument("skeel_radius: a square matrix of up to 128 rows");
  const Peeled peeled(M);
  if (peeled.singular()) return 0;
  if (peeled.empty()) return 1;
  if (const auto ring = peeled.radius_of_ring()) return *ring;
  if (scale) scale(M);
  if (peeled.whole()) return skeel_radius_of_core(M);
  const auto rows = peeled.rows();
  return skeel_radius_of_core(M(rows, peeled.cols()));
}

double skeel_radius(const MatrixXd& M) {
  MatrixXd copy = M;
  return skeel_radius(copy, {});
}

}  // namespace titop::linalg
