#include <titop/blocks/spring_mass.hpp>

// expect: only the literal 0 may stand alone on the right of an equation
// Only the literal 0 may be written; false is none.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z1.parent.accel = 0;
#ifdef MUST_NOT_COMPILE
  z2.parent.accel = false;
#endif
}
