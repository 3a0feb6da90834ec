#pragma once

#include <string>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// Options of `minimize`.
struct MinimizeOptions {
  double resolution = 0;  ///< also drop modes of visibility up to this; 0: at rounding level only
  int exact_order = -1;   ///< the minimal order, if exact arithmetic has found it; -1: not known
  /// Potential energy x' E x / 2, if it is known (n x n, else empty): it gives the symmetric form
  /// of models whose mass couples the coordinates, as in closed chains. Not used if it does not fit
  /// the model.
  Eigen::MatrixXd energy = {};
  /// Rounding error of each entry of A, B, C and D: matrices of their sizes, or empty for 2.2e-16
  /// of the entry. It decides which integrators count. Not used if it does not fit.
  StateSpace rounding = {};
};

/// A mode that was removed, or that is near the limit.
struct JudgedMode {
  double omega = 0;   ///< |s| [rad/s]
  int states = 1;     ///< 2 for a pair of poles
  double visibility;  ///< see `minimize`; of an integrator: independent part of its row
  double bound;       ///< possible visibility by rounding alone
  std::string why;    ///< "no input moves it", "no output sees it", "its pole is at 0", ...
};

/// Reliability of the order of a model.
struct OrderVerdict {
  bool judged = false;  ///< false: `minimize` has not run; the order is that of the structure
  int order = 0;        ///< of the model
  /// Interval of the minimal order, both ends included; equal: it is decided, up to rounding of the
  /// data. If the self-check reports lost digits, `lowest` counts only states of inputs and outputs
  /// whose dynamics finer arithmetic confirms; if the dense model keeps less than 3 digits
  /// (Certificate::dense_error), `highest` counts all states.
  ///
  /// `System::state_space` also counts small diagrams in exact arithmetic: those of up to 60 states
  /// and 100 unknowns, or, if the order is not decided, up to 100 states and 1,000 unknowns. That
  /// count limits `highest`; if it is below the order, more states are removed, unless the transfer
  /// would lose digits.
  int lowest = 0, highest = 0;
  bool exact = false;   ///< decided by exact arithmetic (compiler/definition/exact_order.hpp)
  double to_fewer = 1;  ///< least visibility among the kept modes: error of removing the next
  double to_more = 0;   ///< largest visibility among the removed modes: error of removing them
  /// Measured relative change of the transfer near the removed modes; negative: not measured. If
  /// nothing is removed: the change was so much larger than the judged visibilities that the modes
  /// were restored.
  double change = -1;
  std::vector<JudgedMode> removed, undecided;

  bool decided() const { return judged && lowest == highest; }
};

/// "order 8; 2 states removed, the mode at 11.4 rad/s: no output sees it (visibility 2e-33,
/// rounding 8e-32); removing the next mode would change the transfer by 3.8e-03", or "order 162,
/// undecided between 94 and 162 at this precision, kept 34 modes, ...". One line.
std::string to_string(const OrderVerdict& verdict);

/// A model without the states that have no effect on its transfer, and the removed modes.
struct Minimized {
  StateSpace model;
  OrderVerdict order;
  std::vector<std::string> notes;  ///< the first is the verdict
};

/// Minimal by effect: a removed mode may be present in the last bits of the data, which the verdict
/// reports. Each mode has a visibility v: the relative half-bandwidth in which it exceeds the rest
/// of the transfer, a pure number, independent of the units of inputs, outputs and states. With the
/// eigenvalue l_j of mode j (below), b_jm its row of B for input m, c_kj its column of C for output
/// k, both in modal coordinates, and sums over all modes i:
///
///     w_i = 1 / max(|l_i - l_j|, 0.01 |l_j|)
///     q_m = sqrt(sum |b_im|^2 w_i),  r_k = sqrt(sum |c_ki|^2 w_i)
///     v_j = max_k(|c_kj| / r_k) max_m(|b_jm| / q_m) / (2 |l_j|)
///
/// Without mode j the transfer changes by at most v_j / zeta_j of the other modes' part near it
/// (zeta_j: its damping ratio). A mode is dropped if its v is below ten times its own rounding
/// bound or 1e-17, and both below 1e-9, or if v is below the resolution; an undecided mode is kept.
/// Modes of equal frequency and damping are rotated among themselves first, so that unreachable
/// ones are separate. An unreachable mode becomes a relation between states, an unobservable one
/// likewise: the others keep name and meaning.
///
/// Undamped or proportionally damped models are treated as symmetric eigenproblems (l = omega^2),
/// those of closed chains with the help of their energy, the others by the eigenvalues of A (l =
/// s). Poles that are equal to rounding, those so near 0 that rounding of A turns their vectors
/// by more than 1e-9 (2.2e-7 of A's norm) and those of a condition number above 1e6 have no
/// reliable vectors: with all poles of their cluster they are split off as
/// a small model (linalg/spectral.hpp), whose controllability and observability staircases
/// determine how many of its states count (minreal/staircase.hpp). Before any pole is computed,
/// states leave that no input reaches or no output sees by the pattern of the matrices, and then
/// the uncontrollable and unobservable part at s = 0 [Popov, Belevitch, Hautus], by the ranks of
/// [A, B] and [A; C] (minreal/at_zero.hpp): momenta that no input changes, rigid motions and rotor
/// angles that no output sees, positions that are functions of other states. Integrators that then
/// act on no other state are separated, and the others judged by themselves. A rank is
/// decided against four samples of rounding, 32 times the largest. The verdict's interval counts
///  - upwards, dropped modes above their own rounding bound, which are present, however small their
///    effect, and those whose bound is above 1.4e-14, which may hide an effect;
///  - downwards, kept modes below 1e-9 within 1e4 of their bound, and any within ten times their
///    bound; integrators and states of such small models within 1e4 of their rounding.
/// A decided order is right up to rounding of the data: effects below their own rounding bound (two
/// frequencies one ulp apart) count as zero, and only exact arithmetic decides about them. Modes
/// are vectors of one size in the states' own units (linalg::similarity_scaling_of_parts): in other
/// units of the model the verdict is the same except for decisions at rounding level, which count
/// as undecided. `System::state_space` first sets entries to 0 that its factors cannot distinguish
/// from 0 (32 times the largest of four samples of rounding), unless that costs the transfer
/// digits. With `exact_order` the least visible modes leave until the order is that one. The
/// transfer is measured before and after, near the removed modes: if it has changed by more than
/// 1e-8 and ten times the resolution, the whole model is the result, and the notes report it. Cost
/// O(n^3). Throws not_finite for entries that are not finite, and size for matrices that do not fit
/// each other or the names of states, inputs and outputs.
Minimized minimize(const StateSpace& model, const MinimizeOptions& options = {});

}  // namespace titop
