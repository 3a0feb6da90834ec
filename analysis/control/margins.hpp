#pragma once

#include <cmath>
#include <complex>
#include <string>
#include <titop/analysis/control/loop.hpp>
#include <titop/analysis/control/response.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Stability margins of a loop transfer L whose closed loop is 1 + L = 0
/// (analysis/control/loop.hpp).
namespace titop {

/// A margin and the frequency at which it is reached [rad/s].
struct MarginAt {
  double value = 0;
  double omega = 0;  ///< infinite: at high frequencies, of the direct term
};

/// A point of L(j omega) on the unit circle, or on the negative real axis.
struct LoopCrossing {
  double omega = 0;  ///< [rad/s]
  std::complex<double> L;
};

/// A disk of complex factors, gains with phases: each input of the loop may be multiplied by any
/// factor in it, independently of the others, and the loop stays stable. The factors are (1 +
/// delta) / (1 - delta) with |delta| < alpha / 2, alpha = 2/||S - T||_inf, at most 2. For one loop
/// it is the largest such disk; for several alpha is a lower bound, which depends on the units of
/// their signals [Blight, Dailey, Gangsaas, Int. J. Control 59 (1994); Seiler, Packard, Gahinet,
/// IEEE Control Syst. 40 (2020)].
struct DiskMargin {
  double alpha = 0;  ///< 0 to 2
  double omega = 0;  ///< where ||S - T|| is reached [rad/s]
  double least_gain() const { return (2 - alpha) / (2 + alpha); }
  double largest_gain() const { return (2 + alpha) / (2 - alpha); }  ///< infinite for alpha = 2
  double phase() const { return 2 * std::atan(alpha / 2); }          ///< [rad], at a gain of 1
};

/// Margins of one loop, all others closed. A margin is infinite if no change of its kind makes the
/// loop unstable; all are 0 if the closed loop is not stable.
struct LoopMargins {
  std::string point;      ///< "attitude(2)"
  MarginAt larger_gain;   ///< least factor above 1 that brings L to -1; see `decibels`
  MarginAt smaller_gain;  ///< largest factor below 1 that brings L to -1; 0: none
  MarginAt phase;         ///< least phase shift, of either sign, that brings L to -1 [rad]
  MarginAt delay;         ///< least additional delay that brings L to -1 [s]; 0 if |L| >= 1 at high
                          ///< frequencies
  MarginAt nearest;       ///< least distance of L(j omega) to -1: 1/||S||_inf
  DiskMargin disk;
  std::vector<LoopCrossing> unit;      ///< all crossings of |L| = 1, by frequency
  std::vector<LoopCrossing> negative;  ///< all crossings of the negative real axis, by frequency
};

/// Stability of a loop by two counts: closed-loop poles, and the Nyquist curve.
struct NyquistCount {
  int open_right = 0;      ///< P: poles of L right of the axis
  int closed_right = 0;    ///< Z: closed-loop poles right of the axis; with a delay P + N
  int closed_on_axis = 0;  ///< closed-loop poles on the axis, up to the rounding of their matrix;
                           ///< with a delay 1 if L comes closer to -1 than 1.5e-8, or does
                           ///< not see a pole on the axis
  /// N: clockwise turns of det(1 + L(s)) about 0 as s goes up the imaginary axis, right of poles on
  /// it. Not counted (0) with closed-loop poles on the axis.
  int encirclements = 0;
  bool agree = false;  ///< N = Z - P; with a delay, for which Z is not counted: N is whole
};

/// Margins of a loop.
struct Margins {
  bool stable = false;  ///< no closed-loop pole right of the axis or on it, and the counts agree
  NyquistCount nyquist;
  DiskMargin disk;                 ///< of all loops at once: at most that of each alone
  MarginAt nearest;                ///< 1/||S||_inf, of all loops at once
  std::vector<LoopMargins> loops;  ///< of each loop alone, the others closed
  /// Of a ControlLoop: the warnings of L.log() and L.dense_log(), such as lost digits of L or
  /// states that may be superfluous. These margins are those of L as it is: see docs/errors.md.
  std::vector<std::string> warnings = {};
};

/// Options of `margins`.
struct MarginOptions {
  /// A delay in the loop [s], exact: L(s) e^(-delay s). One loop without a direct term. Margins are
  /// then found on a grid that follows the delay's phase, and refined.
  double delay = 0;
};

/// Margins of a loop by its state-space model L (n x n). Frequencies at which |L| = 1, or at which
/// L is real, are zeros of L(s) L(-s) - 1 and of L(s) - L(-s) (transmission_zeros), refined on L
/// itself by bracketing [Alefeld, Potra, Shi 1995]. They are also searched for between all poles
/// and zeros of L, so that none is missed by rounding of a zero. Accuracy: 1e-12 of a frequency, or
/// 1e-8 where two of them merge (the curve touches the circle or the axis). Norms by `norm_hinf`.
///
/// Modes that are unreachable or unobservable from the cut are not in L: System::poles() shows
/// their stability. A margin is that of changes of this loop alone.
///
/// Throws size for an L that is not square or whose matrices do not fit each other, not_finite,
/// ill_posed if 1 + L is singular at high frequencies, bad_value for a delay that is negative or
/// not finite, in more than one loop, in a loop with a direct term, or of more than 1e5 quarter
/// turns where L matters, and for more than kMostStatesOfHinf states (norm_hinf). O(1000 n^3).
Margins margins(const StateSpace& L, const MarginOptions& options = {});
/// Of ControlLoop::L.state_space(): of the minimal L, with the names of the loop points, and the
/// warnings of its log.
Margins margins(const ControlLoop& loop, const MarginOptions& options = {});

/// A table, with dB and degrees; if the loop is not stable, the counts of unstable poles instead;
/// then the warnings.
std::string to_string(const Margins& margins);

}  // namespace titop
