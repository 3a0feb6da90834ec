#pragma once

#include <string>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

struct MinimizeOptions {
  double resolution = 0;  ///< also drop modes of visibility up to this; 0: only rounding's own
};

/// A model without what cannot matter to its transfer, and what was taken out.
struct Minimized {
  StateSpace model;
  int removed = 0;                 ///< states
  double largest_removed = 0;      ///< largest visibility among the removed modes
  double smallest_kept = 1;        ///< smallest visibility among the kept ones
  bool undecided = false;          ///< a kept mode lies below 1e-9: it may be rounding
  std::vector<std::string> notes;  ///< in plain words
};

/// Minimal by effect. Each mode has a visibility v: the relative half-bandwidth in which it stands
/// out of the rest of the transfer, a pure number in which every input, output and unit cancels:
///
///     w_i = 1 / max(|l_i - l_j|, 0.01 l_j),  q = sqrt(sum b_i^2 w_i),  r = sqrt(sum c_i^2 w_i)
///     v_j = max_k(|c_kj| / r_k) max_l(|b_jl| / q_l) / (2 l_j)
///
/// A mode is dropped if its v lies below ten times its own rounding bound and below 1e-9, or below
/// 1e-17, or below the resolution; in doubt it stays. Modes of equal frequency are turned among
/// themselves first, so that what no input moves stands alone. A mode that no input moves becomes a
/// relation between states, one that no output sees likewise: the rest keep name and meaning.
/// Undamped or proportionally damped models are treated as symmetric eigenproblems; the others by
/// eigenvalues of A with the bound 1e-17 only; eigenvalues at 0 and ill-conditioned ones are kept.
/// Cost O(n^3).
Minimized minimize(const StateSpace& model, const MinimizeOptions& options = {});

}  // namespace titop
