#pragma once

#include "generate/draws.hpp"

/// Words in which the options of all random scenes are given.
namespace titop::generate {

enum class Family {
  scalar,   ///< one degree of freedom per junction: spring-masses
  spatial,  ///< six: bodies, hinges and slides
  mixed     ///< spatial, with spring-masses hanging on the bodies along oblique directions
};
enum class Damping { none, some, all };

enum class Shape {
  chain,
  tree,  ///< each body on a random one of those before it
  star,
  binary,  ///< a balanced tree of two branches at each body
  comb     ///< a chain of the even bodies, each of which carries one more
};

/// The body on which body i > 0 is mounted. Draws one number for a tree, else none.
template <class Bits>
int parent_of(Shape shape, int i, Draws<Bits>& draws) {
  switch (shape) {
    case Shape::tree: return draws.below(i);
    case Shape::star: return 0;
    case Shape::binary: return (i - 1) / 2;
    case Shape::comb: return i % 2 == 0 ? i - 2 : i - 1;
    case Shape::chain: break;
  }
  return i - 1;
}

}  // namespace titop::generate
