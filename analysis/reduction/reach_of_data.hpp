#pragma once

#include <titop/analysis/reduction/scene.hpp>
#include <titop/compiler/system/system_data.hpp>

/// Frequency limit of a body's own data. For the library's own files only.
namespace titop::detail {

/// Modal data describe a body up to its highest mode; the usual rule of component modes is 1.5
/// times the band. Returns a warning for each body whose data end below that: the bound of the
/// reduction does not contain modes that the data lack. O(modes).
std::vector<Note> reach_of_data(const SystemData& data, const Scene& scene);

}  // namespace titop::detail
