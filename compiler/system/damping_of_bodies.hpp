#pragma once

#include <titop/compiler/minreal/poles.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <vector>

/// Assembled modes beside the damping ratios of their bodies. For the compiler's own files.
namespace titop::detail {

/// Sets Pole::least_xi and largest_xi of oscillating poles that are damped unlike their bodies.
/// Bodies are blocks with a modal form, of which a mode is damped. O(poles and modes).
void compare_with_bodies(const SystemData& data, std::vector<Pole>& poles);

/// True if any block with a modal form is damped.
bool has_damped_bodies(const SystemData& data);

/// One note for all those of less damping, one for those of more; none if there are none.
std::vector<Note> damping_notes(const std::vector<Pole>& poles);

}  // namespace titop::detail
