#pragma once

#include <titop/analysis/certify/certify_full.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Items of the full certificate (analysis/certify/certify_full.hpp). For the library's own files.
namespace titop::certification {

struct FoundPoles {
  FullCertificate::Poles poles;
  std::vector<double> omegas;  ///< |s| of poles that are neither 0 nor rounding, ascending
  struct Right {
    std::complex<double> s;
    double rounding;  ///< possible change by rounding
  };
  std::vector<Right> right;  ///< of the axis, both of a pair
};

/// Poles of the dense model against the factors, without those that rounding may have made of 0 or
/// moved by more than 1e-8 of their size: `rounding` of each entry of A, and the error of
/// eigenvalues in double.
FoundPoles check_poles(const System& system, const StateSpace& model,
                       const Eigen::MatrixXd& rounding);

/// Those of these poles that are the minimal model's, too: they affect a transfer. O(n^3) if
/// there are any.
std::vector<FoundPoles::Right> shown(const std::vector<FoundPoles::Right>& right,
                                     const StateSpace& minimal);

/// Points right of the axis on circles about these poles, of a tenth and a thousandth of their
/// distance from it. A passive system has no pole there: around one G / s takes every phase,
/// also those of delivered energy.
std::vector<std::complex<double>> around(const std::vector<FoundPoles::Right>& growing);

}  // namespace titop::certification
