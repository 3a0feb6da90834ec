#pragma once

#include <functional>

#include "wild/oracle/scene.hpp"

namespace wild {

/// The scene in words and numbers, to be read by a person.
std::string print(const Scene& scene);

/// The smallest scene found that still fails: removes parts and rounds numbers as long as `fails`
/// returns true, in at most `tries` calls.
Scene shrink(Scene scene, const std::function<bool(const Scene&)>& fails, int tries);

}  // namespace wild
