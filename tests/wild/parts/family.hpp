#pragma once

#include <string>

#include "wild/oracle/draw.hpp"

namespace wild {

/// A kind of scenes with the first of its seeds.
struct Family {
  std::string name;
  Scene (*draw)(Rng&);
  /// Share of the scenes that may be refused falsely.
  double refused_falsely = 0;
};

/// Judges this family's share of the 500 scenes (of TITOP_WILD_SCENES, if that is set): no wrong
/// answer in silence, no more false refusals than the family allows, one scene of a hundred wrong
/// with a warning, one without a verdict. The first failing scene is shrunk and printed.
void demand_right(const Family& family);

}  // namespace wild
