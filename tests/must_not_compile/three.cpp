#include <titop/blocks/spring_mass.hpp>

// Other constants than 0 need an input.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z1.parent.accel = 0;
#ifdef MUST_NOT_COMPILE
  z2.parent.accel = 3;
#endif
}
