#pragma once

#include "frames.hpp"

namespace loop_test {

/// What to make of a frame.
struct FrameScene {
  const Frame& frame;
  int read = -1;  ///< a joint that hangs a body: the wrench there of the body on what it hangs on
  bool driven = false;  ///< the first body moves as input A says
};

/// The diagram of a frame (frames.hpp), as a user writes one: input U pushes, outputs pushed and
/// watched; input A and output force as the scene says.
titop::Diagram diagram_of(const FrameScene& scene);

}  // namespace loop_test
