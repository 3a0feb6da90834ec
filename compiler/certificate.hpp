#pragma once

#include <complex>
#include <string>

namespace titop {

/// What was checked of a compiled system, and how well it holds. Every number is dimensionless;
/// what is not listed was not checked.
struct Certificate {
  /// Largest |left - right| over (sum of magnitudes of the terms) among all equations of the
  /// diagram AS WRITTEN, for one random input, all signals computed by the compiled system: at one
  /// instant, by the very factors that the model is written from (what the input does not move at
  /// once is moved by inputs of size 1), or at one real s: with positions or rates in the
  /// equations, states that follow from others, in a reduced (singular) scene, or where digits may
  /// be lost. Beside an instant also the responses at s of the first two blocks of each type
  /// against their A, B, C, D. Negative where nothing moves: without inputs, where there is no
  /// instant or digits may be lost there. Rounding is about 1e-16 times the length of a row. What
  /// is above 1e-9 is looked at again: 1e4 times a sample of the signals' rounding is taken from
  /// the difference first, and what chains that hold something twice make 0 may be 1e-14 of the
  /// largest translation, rotation, force or torque of all points. So a number above 1e-9 is what
  /// rounding does not explain.
  double residual = 0;
  std::string residual_where;  ///< the equation or block that has it
  /// That real s [rad/s]; at an instant the states are about those that single blocks have there.
  double s = 0;
  bool at_instant = false;  ///< which of the two
  /// Largest difference between xdot, y of the dense model and of the factors, for one random x and
  /// for one random u, beside the terms that they are made of: of a block's states, of the outputs
  /// of one unit. Where the factors themselves lose digits, what cancels there counts as a term.
  /// Negative where no dense model has been written.
  double dense_against_factors = -1;
  /// What writing the dense model down costs: the largest change of an output that its rounding
  /// makes, over the largest size of that output, at s from the slowest mode that the outputs show
  /// (or, where that is not to be seen, from far below the blocks' frequencies) to above the
  /// blocks' frequencies and those of the assembly (by products of two entries of A), but where the
  /// factors themselves have no digit, at all or of that output (the log says so then)
  /// (residual of the factors' states in the dense model, carried to the outputs by the factors).
  /// By inputs of one unit: random ones, three translations or rotations of a port together; from
  /// the ninth unit on some share a column. Outputs likewise; what is 0 but for rounding, or 1e-14
  /// of what stands in its row and column (what turned frames leave of a 0), counts beside its
  /// neighbours. The same in all units of inputs and outputs; in other units of states and time
  /// other numbers are written, and round differently. Above 1e-9 and up to 100 states it is at
  /// most 30 times what the model's own answers are off by, as the residual itself can round where
  /// a point has hardly any mass. Negative where no dense model has been written, where one has no
  /// states, no inputs or no outputs, and where the factors have no digit anywhere. Above 1e-9 the
  /// log warns, and names output and input (up to eight units).
  double dense_error = -1;
  std::complex<double> dense_error_s;  ///< where it is largest
  /// The same over the size of the output at that same s, far below the slowest mode, too: there an
  /// acceleration may fall with s^2, and what free motion keeps of its digits in A, B, C, D with
  /// it. It grows towards lower s than those tried. Above 1e-6 the log warns of it, too, where it
  /// costs another digit.
  double dense_error_where_small = -1;
  std::complex<double> dense_error_where_small_s;  ///< where it is largest
  /// Smallest pivot over the sum of magnitudes that formed it: 1 no cancellation, 1e-16 nothing
  /// left. Invariant under any change of units.
  double weakest_pivot = 1;
  std::string weakest_where;  ///< signal
  double pivot_growth = 1;  ///< largest size of a row over the least before, all along the tree
  /// Largest margin rho(|L^-1| |L|) of an algebraic loop with matrix L, and its first signal: 1 for
  /// no loop, 4/delta at distance delta from singular; invariant under any change of units.
  double margin = 1;
  bool margin_is_exact = true;  ///< false where some loops were too large for it (see the notes),
                                ///< or have no inverse in double (50 digits, or states, decide)
  std::string margin_where;
  int fronts = 0;         ///< of the elimination
  int fronts_made = 0;    ///< of them, by the last compile or update; the others are shared
  int plans_renewed = 0;  ///< updates since compile that found the scaling, or all, anew
  double seconds = 0;     ///< what this check cost
};

/// One line per item, in plain words.
std::string to_string(const Certificate& certificate);

}  // namespace titop
