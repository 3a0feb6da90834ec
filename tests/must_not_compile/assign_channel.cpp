#include <titop/blocks/spring_mass.hpp>

// A channel has two sides: an equation must name the driven one.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z2.parent.accel = z1.child.accel;
#ifdef MUST_NOT_COMPILE
  z2.parent = z1.child;
#endif
}
