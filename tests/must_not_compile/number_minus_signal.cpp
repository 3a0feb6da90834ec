#include <titop/blocks/spring_mass.hpp>

// expect: a signal cannot be subtracted from a number or parameter
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  [[maybe_unused]] const Param p = d.param("p", 2);
  auto z = d.add("z", SpringMass{});
  z.child.force = -z.stretch;
#ifdef MUST_NOT_COMPILE
  z.parent.force = 0 - z.stretch;
#endif
}
