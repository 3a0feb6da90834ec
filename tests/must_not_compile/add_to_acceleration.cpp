#include <titop/blocks/spring_mass.hpp>

// Forces add up at a point; motions do not.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z1.child.force += z2.parent.force;
#ifdef MUST_NOT_COMPILE
  z1.child.accel += z2.parent.accel;
#endif
}
