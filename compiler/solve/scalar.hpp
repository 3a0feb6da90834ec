#pragma once

#include <cmath>
#include <complex>
#include <limits>

/// What the kernel asks of a scalar, real or complex, of any precision.
namespace titop::solve {

template <class T>
struct Scalar {
  using Real = T;
  static constexpr double epsilon() {
    return static_cast<double>(std::numeric_limits<T>::epsilon());
  }
  static double size(const T& x) {
    using std::abs;
    return static_cast<double>(abs(x));
  }
};

/// Complex numbers are measured by |re| + |im|: within a factor sqrt(2) of the modulus, without
/// its square root.
template <class T>
struct Scalar<std::complex<T>> {
  using Real = T;
  static constexpr double epsilon() { return Scalar<T>::epsilon(); }
  static double size(const std::complex<T>& x) {
    return Scalar<T>::size(x.real()) + Scalar<T>::size(x.imag());
  }
};

template <class T>
double size_of(const T& x) {
  return Scalar<T>::size(x);
}

}  // namespace titop::solve
