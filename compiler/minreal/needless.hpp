#pragma once

#include <string>
#include <titop/compiler/certificate/sampled.hpp>
#include <titop/compiler/minreal/integrators.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <vector>

/// Integrators without effect on the transfer: rigid motions that no input drives or that cancel in
/// all outputs, positions that are functions of the other states. For the compiler's own files.
namespace titop::modes {

/// The rest of a decoupled model (integrators.hpp); entries at rounding level are 0. None if the
/// rest has a pole at 0 too.
std::optional<StateSpace> decoupled_rest(const Sampled& sampled, const IntegratorSplit& states);

/// Removed integrators, and doubtful ones.
struct Needless {
  std::vector<JudgedMode> removed;
  int hidden = 0;                    ///< of these, possibly hidden by rounding
  std::vector<JudgedMode> doubtful;  ///< kept, but possibly rounding alone
  std::vector<std::string> notes;
};

/// Removes from the model and its samples the integrators that do not count: with zdot = N z + B u,
/// their part without modes (integrators.hpp), the rank of [B, N B, ...] determines which depend on
/// the other states, and that of [C; C N; ...] which are unobservable (independent_rows.hpp).
/// States keep their names, and their meaning except as noted. None, without any change, if the
/// other states have a pole at 0 too. O(n^3).
std::optional<Needless> take_out_needless(Sampled& sampled);

}  // namespace titop::modes
