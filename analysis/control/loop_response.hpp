#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/graph/linalg/shifted.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// L along the imaginary axis, and the frequencies that structure it. For the folder's own files.
namespace titop::detail {

/// L(s) e^(-delay s) of a model at many s.
class LoopResponse {
 public:
  LoopResponse(const StateSpace& L, double delay);

  /// n x n; not finite if s - A is singular, very large near a pole.
  Eigen::MatrixXcd at(std::complex<double> s) const;
  /// The only entry at s = j omega, of one loop; infinite omega: the direct term.
  std::complex<double> at(double omega) const;
  double delay() const { return delay_; }

 private:
  Eigen::MatrixXd C_, D_;
  linalg::ShiftedSolver solver_;
  double delay_;
};

/// Poles of a model [rad/s], each of a pair: those at 0 exactly (compiler/minreal/poles.hpp).
std::vector<std::complex<double>> all_poles(const StateSpace& model);

/// Right of the axis, on it (up to the rounding of the model's poles; their real part is then 0),
/// or left of it.
enum class Side { left, axis, right };
struct SidedPole {
  std::complex<double> s;
  Side side = Side::left;
};
/// `period` [s] > 0: of a discrete model whose image by w = c (z - 1) / (z + 1), c = 2 / period,
/// this is. Rounding of its A moves a simple pole z by dz, and w by dz |c - w|^2 / (2 c): near z =
/// 1 by more than the rounding of w's own A. (It splits a double pole by half of the digits.)
std::vector<SidedPole> sided_poles(const StateSpace& model, double period = 0);

/// Frequencies [rad/s], ascending and different, above 0, at which or between which |L| and arg L
/// change: |s| and Im s of the roots given, two decades beyond both ends, and the geometric means
/// between neighbours. With a delay, where crossings are found by changes of sign alone, also:
/// steps of a quarter turn up to `end`; around each root half its half width |Re s| (at
/// least 1.5e-8 of |Im s|), doubled up to |Im s| / 2, since near a resonance L turns within a few
/// half widths.
std::vector<double> structured(const std::vector<std::complex<double>>& roots, double delay,
                               double end);

/// The frequency [rad/s] up to which the turns of a delay count, of a loop without a direct term:
/// beyond it |L| < 1, and |L| is less than in two whole turns below it. `roots`: poles and zeros
/// of L, and frequencies at which |L| = 1. Throws bad_value for more than 1e5 quarter turns.
double end_of_turns(const LoopResponse& response, const std::vector<std::complex<double>>& roots);

}  // namespace titop::detail
