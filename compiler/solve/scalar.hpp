#pragma once

#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <titop/compiler/solve/double_double.hpp>
#include <type_traits>

/// Operations that the kernel needs of a scalar, real or complex, of any precision.
namespace titop::solve {

using Complex50 = boost::multiprecision::cpp_complex_50;

/// Calls X(T) for every scalar that one s is evaluated with.
#define TITOP_COMPLEX_SCALARS(X)                \
  X(std::complex<double>)                       \
  X(std::complex<long double>)                  \
  X(std::complex<::titop::solve::DoubleDouble>) \
  X(::titop::solve::Complex50)

template <class T>
struct Scalar {
  static double epsilon() { return static_cast<double>(std::numeric_limits<T>::epsilon()); }
  static double size(const T& x) {
    using std::abs;
    return static_cast<double>(abs(x));
  }
  static T from(double x) { return static_cast<T>(x); }
  /// At a real s: a block's response there is real, too.
  static T from(std::complex<double> x) { return static_cast<T>(x.real()); }
  static double round(const T& x) { return static_cast<double>(x); }
};

/// Complex numbers are measured by |re| + |im|: within a factor sqrt(2) of the modulus, without
/// its square root.
template <class T>
struct Scalar<std::complex<T>> {
  static double epsilon() { return Scalar<T>::epsilon(); }
  static double size(const std::complex<T>& x) {
    return Scalar<T>::size(x.real()) + Scalar<T>::size(x.imag());
  }
  static std::complex<T> from(std::complex<double> x) {
    return {static_cast<T>(x.real()), static_cast<T>(x.imag())};
  }
  static std::complex<T> from(double x) { return static_cast<T>(x); }
  static std::complex<double> round(const std::complex<T>& x) {
    return {static_cast<double>(x.real()), static_cast<double>(x.imag())};
  }
};

template <>
struct Scalar<Complex50> {
  static double epsilon() { return 1e-50; }
  static double size(const Complex50& x) {
    return static_cast<double>(abs(x.real()) + abs(x.imag()));
  }
  static Complex50 from(std::complex<double> x) { return {x.real(), x.imag()}; }
  static Complex50 from(double x) { return Complex50(x); }
  static std::complex<double> round(const Complex50& x) {
    return {static_cast<double>(x.real()), static_cast<double>(x.imag())};
  }
};

/// x as a T: data are doubles, real or complex.
template <class T, class X>
T lift(const X& x) {
  if constexpr (std::is_same_v<T, X>)
    return x;
  else
    return Scalar<T>::from(x);
}

/// The matrix m with entries of type T.
template <class T, class Matrix>
auto lifted(const Matrix& m) {
  return m.unaryExpr([](const typename Matrix::Scalar& x) -> T { return lift<T>(x); });
}

/// The matrix m rounded to complex numbers of double.
template <class Matrix>
auto in_double(const Matrix& m) {
  using T = typename Matrix::Scalar;
  return m.unaryExpr([](const T& x) -> std::complex<double> { return Scalar<T>::round(x); });
}

template <class T>
double size_of(const T& x) {
  return Scalar<T>::size(x);
}

}  // namespace titop::solve
