#include <titop/blocks/spring_mass.hpp>

// expect: a quotient by a parameter p is not a parameter
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  [[maybe_unused]] const Param p = d.param("p", 2);
  auto z = d.add("z", SpringMass{});
  z.child.force = z.stretch * p;
#ifdef MUST_NOT_COMPILE
  z.parent.force = 1 / p * z.stretch;
#endif
}
