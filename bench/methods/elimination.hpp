#pragma once

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <complex>
#include <stdexcept>
#include <titop/compiler/solve/kernels.hpp>
#include <utility>
#include <vector>

/// Plain elimination in any complex number type: used by the oracle and by the methods at one s.
namespace titop_bench {

using Digits50 = boost::multiprecision::cpp_complex_50;
using Digits150 = boost::multiprecision::number<
    boost::multiprecision::complex_adaptor<boost::multiprecision::cpp_bin_float<150>>>;

template <class T>
using RealOf = std::decay_t<decltype(std::declval<const T&>().real())>;

template <class T>
T number(double re, double im = 0) {
  return T(static_cast<RealOf<T>>(re), static_cast<RealOf<T>>(im));
}
template <class T>
std::complex<double> rounded(const T& x) {
  return {static_cast<double>(x.real()), static_cast<double>(x.imag())};
}

/// |re| + |im|.
template <class T>
RealOf<T> magnitude(const T& x) {
  using std::abs;
  return abs(x.real()) + abs(x.imag());
}

/// Dense matrix, row by row.
template <class T>
class Table {
 public:
  using Index = Eigen::Index;
  Table(Index rows, Index cols)
      : rows_(rows), cols_(cols), values_(at(rows * cols), number<T>(0)) {}
  explicit Table(const Eigen::MatrixXd& m) : Table(m.rows(), m.cols()) {
    for (Index i = 0; i < rows_; ++i)
      for (Index j = 0; j < cols_; ++j) (*this)(i, j) = number<T>(m(i, j));
  }
  T& operator()(Index i, Index j) { return values_[at(i * cols_ + j)]; }
  const T& operator()(Index i, Index j) const { return values_[at(i * cols_ + j)]; }
  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Row `to` from column `first` on, less a times row `from` of `other`.
  void subtract(const T& a, const Table& other, Index from, Index to, Index first = 0) {
    titop::solve::subtract(cols_ - first, a, other.row(from) + first, row(to) + first);
  }
  void swap_rows(Index i, Index j) {
    if (i != j) std::swap_ranges(row(i), row(i) + cols_, row(j));
  }
  Eigen::MatrixXcd to_double() const {
    Eigen::MatrixXcd m(rows_, cols_);
    for (Index i = 0; i < rows_; ++i)
      for (Index j = 0; j < cols_; ++j) m(i, j) = rounded((*this)(i, j));
    return m;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  T* row(Index i) { return values_.data() + i * cols_; }
  const T* row(Index i) const { return values_.data() + i * cols_; }
  Index rows_, cols_;
  std::vector<T> values_;
};

template <class T>
Table<T> product(const Table<T>& A, const Table<T>& B) {
  Table<T> C(A.rows(), B.cols());
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index k = 0; k < A.cols(); ++k)
      if (A(i, k) != number<T>(0)) C.subtract(-A(i, k), B, k, i);
  return C;
}

/// Gauss with partial pivoting.
template <class T>
class Lu {
 public:
  /// Throws runtime_error if a column has no pivot.
  explicit Lu(Table<T> M) : M_(std::move(M)) {
    const Eigen::Index n = M_.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      Eigen::Index pivot = k;
      for (Eigen::Index i = k + 1; i < n; ++i)
        if (magnitude(M_(i, k)) > magnitude(M_(pivot, k))) pivot = i;
      if (M_(pivot, k) == number<T>(0)) throw std::runtime_error("no pivot");
      M_.swap_rows(k, pivot);
      pivots_.push_back(pivot);
      for (Eigen::Index i = k + 1; i < n; ++i) {
        if (M_(i, k) == number<T>(0)) continue;
        M_(i, k) /= M_(k, k);
        M_.subtract(T(M_(i, k)), M_, k, i, k + 1);
      }
    }
  }

  /// Y = M^-1 Y.
  void solve(Table<T>& Y) const {
    const Eigen::Index n = M_.rows();
    for (Eigen::Index k = 0; k < n; ++k) Y.swap_rows(k, pivots_[static_cast<std::size_t>(k)]);
    for (Eigen::Index k = 0; k < n; ++k)
      for (Eigen::Index i = k + 1; i < n; ++i)
        if (M_(i, k) != number<T>(0)) Y.subtract(M_(i, k), Y, k, i);
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      for (Eigen::Index j = 0; j < Y.cols(); ++j) Y(k, j) /= M_(k, k);
      for (Eigen::Index i = 0; i < k; ++i)
        if (M_(i, k) != number<T>(0)) Y.subtract(M_(i, k), Y, k, i);
    }
  }

 private:
  Table<T> M_;
  std::vector<Eigen::Index> pivots_;
};

/// Y = M^-1 Y. Throws as Lu does.
template <class T>
void solve(Table<T> M, Table<T>& Y) {
  Lu<T>(std::move(M)).solve(Y);
}

/// The same with one step of iterative refinement, its residual in T as well.
template <class T>
void solve_refined(const Table<T>& M, Table<T>& Y) {
  const Lu<T> lu(M);
  Table<T> X = Y;
  lu.solve(X);
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index k = 0; k < M.cols(); ++k)
      if (M(i, k) != number<T>(0)) Y.subtract(M(i, k), X, k, i);
  lu.solve(Y);
  for (Eigen::Index i = 0; i < Y.rows(); ++i) Y.subtract(number<T>(-1), X, i, i);
}

template <class T>
Table<T> part(const Table<T>& M, Eigen::Index row, Eigen::Index col, Eigen::Index rows,
              Eigen::Index cols) {
  Table<T> m(rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cols; ++j) m(i, j) = M(row + i, col + j);
  return m;
}

/// Y = M^-1 Y, Gauss-Jordan by blocks: the rows of each block times the inverse of its own diagonal
/// block, then out of all others. `first`: where each block begins; the last: how many rows.
template <class T>
void solve_by_blocks(Table<T> M, Table<T>& Y, const std::vector<Eigen::Index>& first) {
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    const Eigen::Index begin = first[i], n = first[i + 1] - begin;
    if (n == 0) continue;
    Table<T> inverse{Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))};
    solve(part(M, begin, begin, n, n), inverse);
    for (Table<T>* rows : {&M, &Y}) {
      const Table<T> scaled = product(inverse, part(*rows, begin, 0, n, rows->cols()));
      for (Eigen::Index r = 0; r < n; ++r)
        for (Eigen::Index c = 0; c < scaled.cols(); ++c) (*rows)(begin + r, c) = scaled(r, c);
    }
    for (Eigen::Index r = 0; r < M.rows(); ++r) {
      if (r >= begin && r < begin + n) continue;
      for (Eigen::Index k = 0; k < n; ++k) {
        const T factor = M(r, begin + k);
        if (factor == number<T>(0)) continue;
        M.subtract(factor, M, begin + k, r, begin);
        Y.subtract(factor, Y, begin + k, r);
      }
    }
  }
}

}  // namespace titop_bench
