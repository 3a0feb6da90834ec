#pragma once

#include <boost/multiprecision/cpp_complex.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <complex>

namespace wild {

/// Complex numbers of 64 bits, and of 50 digits.
using WideComplex = std::complex<long double>;
using FiftyComplex = boost::multiprecision::number<
    boost::multiprecision::complex_adaptor<boost::multiprecision::cpp_bin_float<50>>,
    boost::multiprecision::et_off>;

}  // namespace wild
