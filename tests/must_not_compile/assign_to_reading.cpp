#include <titop/blocks/spring_mass.hpp>

// A stretch is a result: nothing can be assigned to it.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z2.parent.accel = z1.stretch;
#ifdef MUST_NOT_COMPILE
  z2.stretch = z1.stretch;
#endif
}
