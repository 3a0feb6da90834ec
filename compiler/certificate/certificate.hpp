#pragma once

#include <complex>
#include <string>
#include <vector>

namespace titop {

/// The checks of a compiled system and their results. Every number is dimensionless; checks that
/// are not listed were not made.
struct Certificate {
  /// Largest |left - right| / (sum of magnitudes of the terms) among all equations of the diagram
  /// AS WRITTEN, for one random input, with all signals computed by the compiled system. Evaluated
  /// at one instant, with the factors from which the model is written (signals without a direct
  /// path from an input are excited by inputs of size 1); or at one real s, if the equations
  /// contain positions or rates, if there are dependent states, in a reduced (singular) scene, or
  /// if digits may be lost. At an instant also the responses at s of the first two blocks of
  /// each type, against their A, B, C, D. Negative if not evaluated: there are no inputs, and an
  /// instant is not possible or may lose digits. Rounding gives about 1e-16 times the length of a
  /// row. A residual above 1e-9 is corrected before it is reported: 1e3 times a sample of the
  /// signals' rounding is subtracted, and residuals of over-constrained loops may be 1.4e-14 of the
  /// largest translation, rotation, force or torque of all points. Rounding therefore does not
  /// explain a value above 1e-9.
  double residual = 0;
  std::string residual_where;  ///< the equation or block with this residual
  /// That real s [rad/s]; at an instant, the s of the blocks' responses.
  double s = 0;
  bool at_instant = false;  ///< true: at an instant; false: at s
  /// Largest difference between the outputs of the transfer at that real s and those of the model
  /// that System::apply computes, for one random input, over the output's size (of one unit). Up to
  /// 1e-9 it counts as 0; above, 1e3 times a sample of the rounding of both is subtracted, and up
  /// to 32 times the digits that double loses there (see the log) it is 0. The two share the
  /// blocks' matrices and the coefficients, but not the elimination, the integrals and the map of
  /// dependent states. Negative if not compared: at an instant, where `residual` itself checks the
  /// signals of apply.
  double apply_against_transfer = -1;
  /// Largest difference between xdot, y of the dense model and of the factors, for one random x and
  /// for one random u, relative to the sum of the terms: over a block's states, or over the outputs
  /// of one unit. If the factors lose digits, cancelling terms count too. Negative in a
  /// certificate of the factors alone, as by System::certificate().
  double dense_against_factors = -1;
  /// Error of the dense model due to rounding of its entries: largest change of an output over the
  /// output's largest size, for s from the slowest mode that the outputs show (if unknown, from far
  /// below the blocks' frequencies) to above the frequencies of the blocks and of the assembly
  /// (products of two entries of A). Points s at which the factors have no digit, at all or of that
  /// output, are left out (dense_log() lists them). Computed as the residual of the factors' states
  /// in the dense model, mapped to the outputs by the factors. Inputs are grouped by unit: random
  /// combinations of the three translations or rotations of a port; from the ninth unit on some
  /// share a column. Outputs likewise; an output at rounding level, or at 1.4e-14 of its row and
  /// column (a 0 after a rotation of frames), is measured relative to its neighbours. Independent
  /// of the units of inputs and outputs; in other units of states and time other entries are
  /// rounded. Above 1e-9 and up to 100 states it is at most 32 times the error of the model's own
  /// outputs, as the residual itself is rounded at a point of very small mass. Negative in a
  /// certificate of the factors alone, if the model has no inputs or no outputs, and if
  /// the factors have no digit at any s. Above 1e-9 dense_log() warns, with output and input (up to
  /// eight units).
  double dense_error = -1;
  std::complex<double> dense_error_s;  ///< s of the largest error
  /// The same over the size of the output at that same s, also far below the slowest mode: there an
  /// acceleration may fall with s^2, and the digits that A, B, C, D keep of a free motion fall with
  /// it. It grows towards s below the lowest point. Above 1e-6 dense_log() warns, if another digit
  /// is lost there, from half the slowest pole on; at all s with a
  /// pole at 0 or more than 600 states.
  double dense_error_where_small = -1;
  std::complex<double> dense_error_where_small_s;  ///< s of the largest error
  /// Smallest pivot over the sum of magnitudes of its terms: 1 no cancellation, 1e-16 no digit.
  /// Invariant under any change of units.
  double weakest_pivot = 1;
  std::string weakest_where;  ///< signal
  double pivot_growth = 1;    ///< largest ratio of a row's size to its least size before
  /// Largest margin rho(|L^-1| |L|) of an algebraic loop with matrix L, and its first signal: the
  /// factor by which the loop may magnify relative errors of its entries. 1 for no loop, 4/delta at
  /// relative distance delta from singular; invariant under any change of units. Above 4e7 the log
  /// warns (docs/errors.md).
  double margin = 1;
  bool margin_is_exact = true;  ///< false if some loops were too large for it (see the notes),
                                ///< or have no inverse in double (the refinement of a known
                                ///< solution decides)
  std::string margin_where;
  /// "p of c": the derivative of block c by p is that of its matrices by differences, as c has no
  /// Block::opened. In the certificate of Derivatives::opened(); else empty.
  std::vector<std::string> by_differences = {};
  int fronts = 0;         ///< of the elimination
  int fronts_made = 0;    ///< computed by the last compile or update; the others are shared
  int plans_renewed = 0;  ///< updates since compile that recomputed the scaling, or all
  double seconds = 0;     ///< of this check
};

/// One line per item.
std::string to_string(const Certificate& certificate);

}  // namespace titop
