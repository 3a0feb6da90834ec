#pragma once

#include <string>
#include <titop/compiler/system.hpp>
#include <utility>
#include <vector>

namespace titop::report {

/// Seconds per pass, in their order.
std::vector<std::pair<std::string, double>> seconds(const System& system);
/// What writing and minimizing the dense model did.
std::vector<Note> dense_notes(const System& system);

}  // namespace titop::report
