#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/blocks/exact_beam.hpp>

namespace titop_test {

/// Y(s) of an ExactBeam, [xdd_C; F_P] by [F_C; xdd_P], 12 x 12, from its boundary value problems in
/// 100 digits: exponential functions with coefficients by the conditions at both ends. Needs
/// material.G and section.I_x.
Eigen::MatrixXcd beam_by_hand(const titop::ExactBeam& beam, std::complex<double> s);

}  // namespace titop_test
