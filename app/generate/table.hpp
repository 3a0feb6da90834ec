#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "generate/ratio.hpp"

/// Linear algebra of the manual assembly, in two kinds of numbers: 100 digits, and integers modulo
/// a prime, in which ranks are exact (the rank of the true fractions is lost only if the prime
/// divides a minor: about once in 1e8).
namespace titop::generate {

using Digits = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                             boost::multiprecision::et_off>;

/// Whole numbers modulo 2^31 - 1.
class Mod {
 public:
  Mod(std::int64_t value = 0)
      : value_(static_cast<std::uint64_t>((value % kPrime + kPrime) % kPrime)) {}
  friend Mod operator+(Mod a, Mod b) { return of(a.value_ + b.value_); }
  friend Mod operator-(Mod a, Mod b) { return of(a.value_ + kPrime - b.value_); }
  friend Mod operator*(Mod a, Mod b) { return of(a.value_ * b.value_); }
  friend Mod operator/(Mod a, Mod b) { return a * b.inverse(); }
  Mod operator-() const { return Mod() - *this; }
  Mod& operator+=(Mod b) { return *this = *this + b; }
  Mod& operator-=(Mod b) { return *this = *this - b; }
  bool is_zero() const { return value_ == 0; }

 private:
  static constexpr std::int64_t kPrime = 2147483647;
  static Mod of(std::uint64_t value) {
    Mod m;
    m.value_ = value % static_cast<std::uint64_t>(kPrime);
    return m;
  }
  Mod inverse() const {  // Fermat: a^(p - 2)
    Mod result = 1, power = *this;
    for (std::int64_t e = kPrime - 2; e > 0; e /= 2, power = power * power)
      if (e % 2) result = result * power;
    return result;
  }
  std::uint64_t value_ = 0;
};

/// Half of 100 digits.
inline constexpr double kRounding = 1e-50;
/// Size of a pivot; 0 at the rounding level.
inline double magnitude(const Digits& x) {
  const double size = std::abs(static_cast<double>(x));
  return size > kRounding ? size : 0;
}
inline double magnitude(Mod x) { return x.is_zero() ? 0 : 1; }

template <class S>
S exactly(const Ratio& r) {
  return S(r.num) / S(r.den);
}

template <class S>
class Table {
 public:
  Table(std::size_t rows = 0, std::size_t cols = 0)
      : rows_(rows), cols_(cols), entries_(rows * cols, S(0)) {}

  std::size_t rows() const { return rows_; }
  std::size_t cols() const { return cols_; }
  S& operator()(std::size_t i, std::size_t j) { return entries_[i * cols_ + j]; }
  const S& operator()(std::size_t i, std::size_t j) const { return entries_[i * cols_ + j]; }

  Table transposed() const {
    Table t(cols_, rows_);
    for (std::size_t i = 0; i < rows_; ++i)
      for (std::size_t j = 0; j < cols_; ++j) t(j, i) = (*this)(i, j);
    return t;
  }
  /// Rows, or columns, of these indices.
  Table rows(const std::vector<std::size_t>& list) const {
    Table t(list.size(), cols_);
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t j = 0; j < cols_; ++j) t(i, j) = (*this)(list[i], j);
    return t;
  }
  Table cols(const std::vector<std::size_t>& list) const {
    return transposed().rows(list).transposed();
  }
  void add(const Table& other, std::size_t row = 0, std::size_t col = 0) {
    for (std::size_t i = 0; i < other.rows_; ++i)
      for (std::size_t j = 0; j < other.cols_; ++j) (*this)(row + i, col + j) += other(i, j);
  }
  void append(const Table& below) {
    rows_ += below.rows_;
    entries_.insert(entries_.end(), below.entries_.begin(), below.entries_.end());
  }

  friend Table operator*(const Table& a, const Table& b) {
    Table c(a.rows_, b.cols_);
    for (std::size_t i = 0; i < a.rows_; ++i)
      for (std::size_t k = 0; k < a.cols_; ++k) {
        if (magnitude(a(i, k)) == 0) continue;
        for (std::size_t j = 0; j < b.cols_; ++j) c(i, j) += a(i, k) * b(k, j);
      }
    return c;
  }
  friend Table operator+(Table a, const Table& b) {
    a.add(b);
    return a;
  }
  Table operator-() const {
    Table t = *this;
    for (S& x : t.entries_) x = -x;
    return t;
  }

 private:
  std::size_t rows_, cols_;
  std::vector<S> entries_;
};

template <class S>
Table<S> identity(std::size_t n) {
  Table<S> t(n, n);
  for (std::size_t i = 0; i < n; ++i) t(i, i) = S(1);
  return t;
}

/// Reduced row echelon form of a, with complete pivoting among the rows left: pivot columns.
template <class S>
std::vector<std::size_t> reduce(Table<S>& a, std::size_t columns) {
  std::vector<std::size_t> pivots;
  std::vector<char> used(columns, 0);
  while (pivots.size() < a.rows()) {
    const std::size_t k = pivots.size();
    std::size_t row = k, col = columns;
    double best = 0;
    for (std::size_t i = k; i < a.rows(); ++i)
      for (std::size_t j = 0; j < columns; ++j)
        if (!used[j] && magnitude(a(i, j)) > best) best = magnitude(a(i, j)), row = i, col = j;
    if (col == columns) break;
    used[col] = 1, pivots.push_back(col);
    const S inverse = S(1) / a(row, col);
    for (std::size_t j = 0; j < a.cols(); ++j) {
      std::swap(a(k, j), a(row, j));
      a(k, j) = a(k, j) * inverse;
    }
    for (std::size_t i = 0; i < a.rows(); ++i) {
      const S f = a(i, col);
      if (i == k || magnitude(f) == 0) continue;
      for (std::size_t j = 0; j < a.cols(); ++j) a(i, j) -= f * a(k, j);
    }
  }
  return pivots;
}

/// A^-1 B. Throws std::domain_error if A is singular.
template <class S>
Table<S> solve(const Table<S>& A, const Table<S>& B) {
  Table<S> both(A.rows(), A.cols() + B.cols());
  both.add(A);
  both.add(B, 0, A.cols());
  const std::vector<std::size_t> pivots = reduce(both, A.cols());
  if (pivots.size() < A.cols()) throw std::domain_error("singular");
  Table<S> X(A.cols(), B.cols());
  for (std::size_t k = 0; k < pivots.size(); ++k)
    for (std::size_t j = 0; j < B.cols(); ++j) X(pivots[k], j) = both(k, A.cols() + j);
  return X;
}

template <class S>
std::size_t rank(Table<S> A) {
  return reduce(A, A.cols()).size();
}

/// Columns that span the null space of A.
template <class S>
Table<S> null_space(Table<S> A) {
  const std::vector<std::size_t> pivots = reduce(A, A.cols());
  std::vector<char> is_pivot(A.cols(), 0);
  for (const std::size_t p : pivots) is_pivot[p] = 1;
  Table<S> N(A.cols(), A.cols() - pivots.size());
  for (std::size_t j = 0, k = 0; j < A.cols(); ++j) {
    if (is_pivot[j]) continue;
    N(j, k) = S(1);
    for (std::size_t i = 0; i < pivots.size(); ++i) N(pivots[i], k) = -A(i, j);
    ++k;
  }
  return N;
}

}  // namespace titop::generate
