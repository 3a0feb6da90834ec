#pragma once

#include <string>
#include <titop/analysis/certify/passivity.hpp>
#include <titop/compiler/certificate/certificate.hpp>
#include <vector>

/// Requirements on a certificate: one rule for the full certificate and for the report. For the
/// library's own files.
namespace titop::certification {

/// Equations, entries of the dense model one by one, reciprocity of a structure.
inline constexpr double kHolds = 1e-8;
/// Allowed rounding error of A, B, C, D: that of code generated from them.
inline constexpr double kDenseHolds = 3e-7;
/// A pole of the dense model is that of the factors, or of the minimal model: to first order only.
inline constexpr double kPoleHolds = 1e-6;

/// The failed checks, in words. `dense`: largest difference between transfers of the dense model
/// and of the factors over a grid; negative if there is none.
std::vector<std::string> basic_faults(const Certificate& certificate, double dense = -1);

}  // namespace titop::certification
