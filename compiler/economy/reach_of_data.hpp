#pragma once

#include <titop/compiler/economy/scene.hpp>
#include <titop/compiler/system_data.hpp>

/// How far a body's own data reach. For the compiler's own files only.
namespace titop::detail {

/// Modal data describe a body up to its highest mode; the usual rule of component modes asks for
/// 1.5 times the band. A warning for each body whose data end below that: no bound on the
/// reduction can see what is not in them. O(modes).
std::vector<Note> reach_of_data(const SystemData& data, const Scene& scene);

}  // namespace titop::detail
