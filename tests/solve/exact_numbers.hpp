#pragma once

#include <boost/multiprecision/cpp_complex.hpp>
#include <titop/compiler/solve/scalar.hpp>

/// Numbers of every scalar type of the solver in 100 digits.
namespace solve_test {

using Exact = boost::multiprecision::cpp_complex_100;
using ExactReal = boost::multiprecision::cpp_bin_float_100;

inline ExactReal exact_part(double x) { return ExactReal(x); }
inline ExactReal exact_part(long double x) { return ExactReal(x); }
inline ExactReal exact_part(const titop::solve::DoubleDouble& x) {
  const double high = static_cast<double>(x);
  return ExactReal(high) + ExactReal(static_cast<double>(x - titop::solve::DoubleDouble(high)));
}
template <class Other>
ExactReal exact_part(const Other& x) {
  return ExactReal(x);
}
inline Exact exact(double x) { return Exact(x); }
template <class T>
Exact exact(const T& z) {
  using Part = std::decay_t<decltype(z.real())>;
  return Exact(exact_part(Part(z.real())), exact_part(Part(z.imag())));
}

}  // namespace solve_test
