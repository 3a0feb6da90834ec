#pragma once

#include <titop/compiler/system_data.hpp>

namespace titop::detail {

/// Blocks whose data have few digits (FromData): throws improper where these decide on a motion or
/// a force though they are zero by their digits, with port and direction; notes where less than a
/// digit is left. One solution by the factors for all of them, and one per degree of freedom of the
/// ports in doubt.
std::vector<Note> judge_data_digits(const SystemData& data);

}  // namespace titop::detail
