#include <titop/blocks/spring_mass.hpp>

// expect: a difference with a parameter p is not a parameter
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  [[maybe_unused]] const Param p = d.param("p", 2);
  auto z = d.add("z", SpringMass{});
  z.child.force = p * z.stretch - 2 * p * z.stretch;
#ifdef MUST_NOT_COMPILE
  z.parent.force = (p - 2 * p) * z.stretch;
#endif
}
