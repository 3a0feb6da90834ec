#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <titop/compiler/solve/row_sums.hpp>
#include <type_traits>

/// The inner loops: y -= a x and similar ones over contiguous entries. Plain loops that a compiler
/// turns into vector instructions; sums are never regrouped, so that every machine gets the same
/// bits.

namespace titop::solve {

/// y -= a x, n entries.
template <class T>
inline void subtract(std::ptrdiff_t n, const T& a, const T* x, T* y) {
  for (std::ptrdiff_t j = 0; j < n; ++j) y[j] -= a * x[j];
}

/// The same with the product written out: the language's own also looks for infinities.
template <class T>
inline void subtract(std::ptrdiff_t n, const std::complex<T>& a, const std::complex<T>* x,
                     std::complex<T>* y) {
  const T re = a.real(), im = a.imag();
  const T* u = reinterpret_cast<const T*>(x);
  T* v = reinterpret_cast<T*>(y);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const T s = u[2 * j], t = u[2 * j + 1];
    v[2 * j] -= re * s - im * t;
    v[2 * j + 1] -= re * t + im * s;
  }
}

/// y -= l[0] x_0 + l[1] x_1 ..., so many rows x_k of m entries each. A single column is summed in
/// registers; there a factor 0 of a value that is not finite is not skipped.
template <class T>
inline void subtract_rows(std::ptrdiff_t count, const T* l, const T* x, std::ptrdiff_t m, T* y) {
  if (m == 1) {
    T sum = y[0];
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      if constexpr (std::is_floating_point_v<T>)
        sum -= l[k] * x[k];
      else if (l[k] != T(0))
        subtract(1, l[k], x + k, &sum);
    }
    y[0] = sum;
    return;
  }
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::complex<double>>)
    subtract_sum(count, l, x, m, y);
  else
    for (std::ptrdiff_t k = 0; k < count; ++k)
      if (l[k] != T(0)) subtract(m, l[k], x + k * m, y);
}

/// x / by, for one `by` and many x.
template <class T>
class Divisor {
 public:
  explicit Divisor(const T& by) : by_(by) {}
  T operator()(const T& x) const { return x / by_; }

 private:
  T by_;
};

/// Complex numbers by Smith's formula [Smith 1962], to a few units of the last place of |x / by|:
/// nothing is squared. The language's own also looks for infinities and takes several times as
/// long.
template <class T>
  requires std::is_floating_point_v<T>
class Divisor<std::complex<T>> {
 public:
  explicit Divisor(const std::complex<T>& by)
      : by_re_(std::abs(by.real()) >= std::abs(by.imag())),
        ratio_(by_re_ ? by.imag() / by.real() : by.real() / by.imag()),
        whole_(by_re_ ? by.real() + by.imag() * ratio_ : by.real() * ratio_ + by.imag()) {}
  std::complex<T> operator()(const std::complex<T>& x) const {
    if (by_re_)
      return {(x.real() + x.imag() * ratio_) / whole_, (x.imag() - x.real() * ratio_) / whole_};
    return {(x.real() * ratio_ + x.imag()) / whole_, (x.imag() * ratio_ - x.real()) / whole_};
  }

 private:
  bool by_re_;  ///< the larger part
  T ratio_, whole_;
};

/// y += a x, n entries.
inline void add(std::ptrdiff_t n, double a, const double* x, double* y) {
  for (std::ptrdiff_t j = 0; j < n; ++j) y[j] += a * x[j];
}

/// y += L x: L rows x cols, column-major, x and y row-major with m columns.
inline void add_dense_product(std::ptrdiff_t rows, std::ptrdiff_t cols, const double* L,
                              const double* x, std::ptrdiff_t m, double* y) {
  for (std::ptrdiff_t k = 0; k < cols; ++k, L += rows, x += m) {
    if (m == 1)
      add(rows, x[0], L, y);
    else
      for (std::ptrdiff_t i = 0; i < rows; ++i) add(m, L[i], x, y + i * m);
  }
}

/// a b for a number b that is real in any case.
template <class T>
inline T times(const T& a, double b) {
  return a * T(b);
}
template <class T>
inline std::complex<T> times(const std::complex<T>& a, double b) {
  return {a.real() * static_cast<T>(b), a.imag() * static_cast<T>(b)};
}

/// y += a x for numbers x that are real in any case, n entries.
template <class T>
inline void add_times(std::ptrdiff_t n, const T& a, const double* x, T* y) {
  for (std::ptrdiff_t j = 0; j < n; ++j) y[j] += times(a, x[j]);
}
template <class T>
inline void add_times(std::ptrdiff_t n, const std::complex<T>& a, const double* x,
                      std::complex<T>* y) {
  const T re = a.real(), im = a.imag();
  T* v = reinterpret_cast<T*>(y);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const T by = static_cast<T>(x[j]);
    v[2 * j] += re * by;
    v[2 * j + 1] += im * by;
  }
}

}  // namespace titop::solve
