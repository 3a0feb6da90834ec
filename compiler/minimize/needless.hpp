#pragma once

#include <string>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/minimize/integrators.hpp>
#include <titop/compiler/minimize/sampled.hpp>
#include <vector>

/// Integrators that the transfer does not need: rigid motions that nothing drives or that cancel in
/// all outputs, positions that the other states hold already. For the compiler's own files.
namespace titop::modes {

/// The rest of a decoupled model (integrators.hpp); entries are 0 that rounding alone may have
/// made. None where the rest has a pole at 0 too.
std::optional<StateSpace> decoupled_rest(const Sampled& sampled, const Integrated& states);

/// What left, and what may have to.
struct Needless {
  std::vector<JudgedMode> removed;
  int hidden = 0;                    ///< of these, what rounding might hide
  std::vector<JudgedMode> doubtful;  ///< stay, and yet rounding may be all there is
  std::vector<std::string> notes;
};

/// Takes out of the model and its samples the integrators that do not count: with zdot = N z + B u
/// what they are by themselves (integrators.hpp), the rank of [B, N B, ...] says which follow from
/// the other states, and that of [C; C N; ...] which no output sees apart from others
/// (independent_rows.hpp). States keep their names, and their meaning but where a note says so.
/// None, and nothing is changed, where the other states have a pole at 0 too. O(n^3).
std::optional<Needless> take_out_needless(Sampled& sampled);

}  // namespace titop::modes
