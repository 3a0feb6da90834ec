#pragma once

#include <titop/compiler/solve/factored.hpp>

namespace titop::detail {

/// Blocks whose data have few digits (FromData): throws improper if a motion or a force depends on
/// numbers that are zero by these digits, with port and direction; notes if less than one digit
/// remains. One solution by the factors for all of them, and one per degree of freedom of the ports
/// in doubt.
std::vector<Note> judge_data_digits(const Factored& data);

}  // namespace titop::detail
