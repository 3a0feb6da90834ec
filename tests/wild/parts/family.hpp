#pragma once

#include <string>

#include "wild/oracle/draw.hpp"

namespace wild {

/// A kind of scenes with the first of its seeds.
struct Family {
  std::string name;
  Scene (*draw)(Rng&);
  /// Why its scenes are not judged in the tests yet, with the number; empty: they are.
  std::string pending = {};
};

/// Judges this family's share of the 500 scenes (of TITOP_WILD_SCENES, if that is set): no wrong
/// answer in silence, no false refusal. The first failing scene is shrunk and printed. With
/// TITOP_WILD_PENDING=1 families that are pending are judged, too.
void demand_right(const Family& family);

}  // namespace wild
