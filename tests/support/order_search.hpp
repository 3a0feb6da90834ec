#pragma once

#include <complex>
#include <vector>

#include "reduction/tree.hpp"

/// The least order of a reduced model, by search: independent of titop's choice of modes and
/// vectors.
namespace titop_test {

/// A structure in many modes, and the accelerations that a small model of it must have.
struct Searched {
  InModes modes;         ///< of the structure, far beyond the band
  double damping = 0;    ///< of the whole structure, over its stiffness [s]
  double end = 0;        ///< of the band [rad/s]
  Eigen::MatrixXd peak;  ///< scale of each pair
  std::vector<std::complex<double>> s = {};
  std::vector<Eigen::MatrixXcd> H = {};  ///< exact, at these s
};

/// The fewest coordinates found of a real projection (M, D, K of V' . V) with no error of a pair
/// above the accuracy. From modes of the band, responses of all modes, or of those above the band,
/// to single inputs and outputs, and principal components of these, the one is added that leaves
/// the least error, until the accuracy is met; then all that can be spared are removed. Two
/// measures of the error are tried. Returns -1 if the accuracy is not met.
int least_coordinates(const Searched& searched, double accuracy);

}  // namespace titop_test
