#include <titop/blocks/spring_mass.hpp>

// A stretch is a result: it cannot be set to 0.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z2.parent.accel = 0;
#ifdef MUST_NOT_COMPILE
  z2.stretch = 0;
#endif
}
