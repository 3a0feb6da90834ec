#pragma once

#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

/// Checks the internal forces that released closures (Stage::released) leave undetermined: throws
/// kinematic_loop for every output and controller that reads one, or returns notes of them as
/// minimal-norm as chosen by Options::internal_forces. One solution per released direction; if
/// these are more than 32, of 32 sums of them; up to eight steps of refinement if some are read.
std::vector<Note> judge_internal_forces(const Factored& data);

}  // namespace titop::detail
