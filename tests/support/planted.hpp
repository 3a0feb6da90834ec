#pragma once

#include <cstdint>
#include <titop/graph/diagram.hpp>

namespace titop_test {

/// A diagram with parts that its transfer does not need, and the order that it does need.
struct Planted {
  titop::Diagram diagram;
  int order = 0;    ///< minimal
  int planted = 0;  ///< states on top of it
};

/// A chain of masses on the ground, pushed at its end and watched at its start (always minimal:
/// its matrix has no zero off the diagonal), with appendages in two or three equal copies (only
/// their sum moves), filters in equal copies, and filters whose zero another one's pole cancels.
/// Numbers are short fractions in powers of two. Damping: none, proportional, or of some springs.
Planted planted(std::uint64_t seed);

}  // namespace titop_test
