#include <titop/blocks/spring_mass.hpp>

// expect: a number or parameter cannot be added to a signal
// A number cannot be added to a signal: other constants than 0 need an input.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z2.parent.accel = z1.child.accel + 2 * z1.stretch;
#ifdef MUST_NOT_COMPILE
  z2.child.force = z1.parent.force + 2.0;
#endif
}
