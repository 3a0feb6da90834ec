#include <titop/blocks/spring_mass.hpp>

// expect: a product of two parameters p, q is not a parameter
// Both may multiply one signal, and numbers multiply either.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  const Param p = d.param("p", 2), q = d.param("q", 3);
  auto z = d.add("z", SpringMass{.stiffness = -(2 * p) * 3 / 4.0});
  z.child.force = p * (q * z.stretch);
#ifdef MUST_NOT_COMPILE
  z.parent.force = p * q * z.stretch;
#endif
}
