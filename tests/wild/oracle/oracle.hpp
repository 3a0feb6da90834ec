#pragma once

#include <complex>
#include <string>
#include <vector>

#include "wild/oracle/scene.hpp"

/// The exact model of a scene: M, D, K of all bodies in maximal coordinates, constraints with
/// multipliers, controllers as given, and dense elimination at each s. No header of the library is
/// used.
namespace wild {

using Complex = std::complex<double>;

/// Number type: 64 bits of mantissa, or 50 digits.
enum class Digits { wide, fifty };

/// H(s), outputs x inputs, and properties of the scene.
struct Truth {
  std::vector<Eigen::MatrixXcd> H;  ///< per s
  /// Redundant constraints, of over-constrained loops.
  int redundant = 0;
  /// Why there is no answer: an internal force of such a loop is read, two prescribed motions
  /// contradict each other, a posture is nearly singular. Empty: there is one.
  std::string none;
};
Truth truth(const Scene& scene, const std::vector<Complex>& s, Digits digits = Digits::wide);

/// The scene with all numbers changed by `relative` of themselves at random, one by one, as by
/// rounding; chains then do not close exactly.
Scene disturbed(const Scene& scene, double relative, unsigned seed);

/// The response y(t) from rest to input `column` stepping to 1 at time 0, by the inverse
/// Laplace transform on Talbot's contour [Abate, Whitt 2006, sec. 3]; an entry that two orders of
/// it do not agree on to 1e-10 is nan, and so are all if no pivot has a digit in 64 bits.
VectorXd step_response(const Scene& scene, int column, double t);

}  // namespace wild
