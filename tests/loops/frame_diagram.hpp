#pragma once

#include "frames.hpp"

namespace loops_test {

/// Options of a frame's diagram.
struct FrameScene {
  const Frame& frame;
  int read = -1;  ///< a joint that carries a body: output of the body's wrench on its parent there
  bool driven = false;  ///< the first body has the acceleration A, an input
};

/// The diagram of a frame (frames.hpp), as a user writes one: input U pushes, outputs pushed and
/// watched; input A and output force as in the scene.
titop::Diagram diagram_of(const FrameScene& scene);

}  // namespace loops_test
