#include <Eigen/SparseCore>
#include <algorithm>
#include <bitset>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <titop/graph/linalg/skeel.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::linalg {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kSmall = 12;
constexpr int kMost = 128;  ///< rows
/// Small loops are many: no memory is allocated for them.
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kSmall, kSmall>;

constexpr double kSettled = 1e-3;  ///< relative: bounds of a radius that is known
constexpr double kUsual = 1e150;   ///< products of two such numbers do not overflow
constexpr double kTiny = 1e-300;   ///< beside 1: no divisor is 0

/// From M^k, k = 1, 2, 4 ... 1024: the row sums v of M^k give max (M v)_i / v_i, never below the
/// radius [Collatz 1942]; if that stays loose, |M^1024|^(1/1024), the norm's own factor n having
/// become n^(1/1024).
double perron_by_squaring(const SmallMatrix& M) {
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSmall, 1>;
  SmallMatrix power = M;
  double log_scale = 0, weight = 1;
  for (int step = 0; step <= 10; ++step, weight /= 2) {
    const SmallVector v = power.rowwise().sum();
    const double size = v.maxCoeff();
    if (!(size > 0)) return 0;
    if (v.minCoeff() > 0) {
      const SmallVector grown = M.lazyProduct(v).cwiseQuotient(v);
      if (grown.maxCoeff() - grown.minCoeff() <= kSettled * grown.maxCoeff())
        return grown.maxCoeff();
    }
    log_scale += weight * std::log(size);
    if (step == 10) break;
    power /= size;
    power = power.lazyProduct(power).eval();
  }
  return std::exp(log_scale);
}

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Result of power iteration.
struct Powers {
  double radius = 0;     ///< from above
  bool settled = false;  ///< known to kSettled
};

/// Power iteration [Collatz 1942]; `times`: M v. The diagonal of |M^-1| |M| is 1 or more: the
/// iteration does not oscillate.
template <class Times>
Powers perron_by_powers(Eigen::Index n, int steps, Times times) {
  VectorXd v = VectorXd::Ones(n), w, grown;
  for (int step = 0; step < steps; ++step) {
    w = times(v);
    grown = w.cwiseQuotient(v);
    const double most = grown.maxCoeff();
    if (most - grown.minCoeff() <= kSettled * most) return {most, true};
    v = (w / w.maxCoeff()).cwiseMax(kTiny);
  }
  return {grown.maxCoeff(), false};
}

double perron(const SmallMatrix& M) { return perron_by_squaring(M); }
double perron(const RowMatrix& M) {
  return perron_by_powers(M.rows(), 200, [&](const VectorXd& v) -> VectorXd { return M * v; })
      .radius;
}

/// Spectral radius of M: the largest of its irreducible diagonal blocks. Loops that a zero
/// coefficient opens have rows coupled in one direction only, for which power iteration does not
/// converge. Set: of as many bits as rows, `none` empty.
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

/// Pivot row of column k: one with few entries among those that are large enough there. k - 1 if
/// all are 0.
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

/// M^-1 by elimination row by row: most entries of a loop are 0, and zeros are skipped. 0 x 0 if a
/// pivot is 0.
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
  double number() const { return exponent == 0 ? value : std::ldexp(value, exponent); }
  Quotient inverse() const { return {1 / value, -exponent}; }
  static bool is_usual(double x) { return std::abs(x) > 1 / kUsual && std::abs(x) < kUsual; }
};

/// p and 1/p belong to the same ring, turned round.
double skeel_radius_of_ring(Eigen::Index n, const Quotient& product) {
  double p = product.number();
  if (std::abs(p) > 1) p = product.inverse().number();
  double c = std::abs(p);
  Eigen::Index root = n;  // mostly 4, of two channels
  for (; root % 2 == 0; root /= 2) c = std::sqrt(c);
  if (root > 1) c = std::pow(c, 1 / static_cast<double>(root));
  double sum = 0;
  for (Eigen::Index k = 0; k < n; ++k) sum = 1 + c * sum;
  return p == 1 ? 0 : (1 + c) * sum / std::abs(1 - p);
}

/// Removes rows and columns with a single entry, repeatedly: M is block triangular, and the removed
/// ones are diagonal blocks of size 1, with radius 1.
class WithoutSingletons {
 public:
  using List = boost::container::small_vector<Eigen::Index, kSmall>;

  explicit WithoutSingletons(const MatrixXd& M)
      : M_(M), n_(static_cast<std::size_t>(M.rows())), left_(n_), rows_(n_), cols_(n_) {
    const double* value = M.data();
    for (std::size_t j = 0; j < n_; ++j)
      for (std::size_t i = 0; i < n_; ++i)
        if (*value++ != 0) rows_[i].put(j), cols_[j].put(i);
    for (std::size_t before = n_ + 1; left_ > 0 && left_ < before;) {
      before = left_;
      for (std::size_t i = 0; i < n_; ++i)
        if (rows_[i].entries == 1)
          leave(rows_, cols_, i, [&](std::size_t k, std::size_t j) { return entry(k, j); });
      for (std::size_t j = 0; j < n_; ++j)
        if (cols_[j].entries == 1)
          leave(cols_, rows_, j, [&](std::size_t k, std::size_t i) { return entry(i, k); });
    }
  }
  /// Some row or column has no entry.
  bool singular() const {
    return !all(rows_, [](int entries) { return entries != 0; }) ||
           !all(cols_, [](int entries) { return entries != 0; });
  }
  bool whole() const { return left_ == n_; }
  bool empty() const { return left_ == 0; }
  List rows() const { return list(rows_); }
  List cols() const { return list(cols_); }

  /// Spectral radius of the remaining part, if it is one ring, in which every unknown is in its own
  /// row and in the next one's only: (1 + c)(1 + c + ... + c^(n-1)) / |1 - p|, p the product of the
  /// n gains and c = |p|^(1/n). None for others.
  std::optional<double> radius_of_ring() const {
    const auto two = [](int entries) { return entries < 0 || entries == 2; };
    if (!all(rows_, two) || !all(cols_, two)) return {};
    std::size_t start = 0, own = 0, n = 0;
    while (rows_[start].entries < 0) ++start;
    while (cols_[own].entries < 0 || entry(start, own) == 0) ++own;
    // Along the ring: from a row's own entry to its other one, and up or down to the next row.
    std::size_t i = start;
    Quotient product;
    do {
      const std::size_t next = rows_[i].places ^ own;
      product.multiply(-entry(i, next), entry(i, own));
      i ^= cols_[next].places, own = next, ++n;
    } while (i != start);
    if (n != left_) return {};  // several rings
    return skeel_radius_of_ring(static_cast<Eigen::Index>(n), product);
  }

 private:
  /// A row or a column: number of its entries, and the exclusive or of their places. For a single
  /// entry that is its place; for two, it gives the other's place from either one's.
  struct CountedLine {
    int entries = 0;  ///< -1: peeled off
    std::size_t places = 0;
    void put(std::size_t place) { ++entries, places ^= place; }
    void drop(std::size_t place) { --entries, places ^= place; }
  };
  using CountedLines = boost::container::small_vector<CountedLine, kSmall>;

  double entry(std::size_t i, std::size_t j) const {
    return M_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  /// Removes a line with its single entry and the line across it. entry(k, place): of line k there.
  template <class Entry>
  void leave(CountedLines& lines, CountedLines& across, std::size_t line, Entry entry) {
    --left_;
    const std::size_t place = lines[line].places;
    CountedLine& other = across[place];
    lines[line].entries = -1;
    other.drop(line);
    if (other.entries == 1)
      lines[other.places].drop(place);
    else if (other.entries > 1)
      for (std::size_t k = 0; k < n_; ++k)
        if (lines[k].entries > 0 && entry(k, place) != 0) lines[k].drop(place);
    other.entries = -1;
  }
  template <class Test>
  static bool all(const CountedLines& lines, Test test) {
    return std::all_of(lines.begin(), lines.end(),
                       [&](const CountedLine& l) { return test(l.entries); });
  }
  static List list(const CountedLines& lines) {
    List result;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i].entries >= 0) result.push_back(static_cast<Eigen::Index>(i));
    return result;
  }

  const MatrixXd& M_;
  std::size_t n_, left_;
  CountedLines rows_, cols_;
};

double skeel_radius_of_core(const MatrixXd& M) {
  if (M.rows() > kSmall) {
    const RowMatrix inverse = inverse_by_rows<RowMatrix>(M);
    if (inverse.size() == 0) return 0;
    constexpr int kWhole = 25;  // if they do not settle by then, mostly the loop is cut open
    const RowMatrix of_inverse = inverse.cwiseAbs();
    const Eigen::SparseMatrix<double, Eigen::RowMajor> of_M = M.cwiseAbs().sparseView();
    const Powers whole = perron_by_powers(M.rows(), kWhole, [&](const VectorXd& v) -> VectorXd {
      return of_inverse * VectorXd(of_M * v);
    });
    if (whole.settled) return whole.radius;
    return perron_of_parts(product_of_sizes(inverse, M), std::bitset<kMost>());
  }
  const SmallMatrix inverse = inverse_by_rows<SmallMatrix>(M);
  if (inverse.size() == 0) return 0;
  return perron_of_parts<SmallMatrix>(inverse.cwiseAbs().lazyProduct(M.cwiseAbs()),
                                      std::bitset<kSmall>());
}

}  // namespace

double skeel_radius(MatrixXd& M, const std::function<void(MatrixXd&)>& scale) {
  if (M.rows() != M.cols() || M.rows() > kMost)
    throw std::invalid_argument("skeel_radius: a square matrix of up to 128 rows");
  const WithoutSingletons peeled(M);
  if (peeled.empty()) return 1;
  if (peeled.singular()) return 0;
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
