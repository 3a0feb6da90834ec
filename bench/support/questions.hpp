#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Scenes of the small models: those of docs/reduction.
namespace titop_bench {

struct Question {
  std::string name;
  titop::Scene scene;
  /// False: a controller in the loop, no modes of the whole.
  bool structure = true;
  /// The bodies have their own modes up to this frequency [Hz]; the others are omitted.
  std::function<titop::Diagram(double hertz)> with_modes_up_to;

  titop::Diagram diagram() const { return with_modes_up_to(HUGE_VAL); }
};

/// Frame, heavy, satellite, generated, loop. Quick: of bodies with few modes.
std::vector<Question> questions(bool quick);

/// Beams in a zigzag, clamped, wrench at the tip to acceleration there.
titop::Diagram zigzag(const titop::FlexibleBody& beam, int count);

}  // namespace titop_bench
