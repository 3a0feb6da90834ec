#include <titop/blocks/spring_mass.hpp>

// expect: a product of two signals is not linear
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  [[maybe_unused]] const Param p = d.param("p", 2);
  auto z = d.add("z", SpringMass{});
  z.child.force = 2 * z.stretch;
#ifdef MUST_NOT_COMPILE
  z.parent.force = z.stretch * z.child.accel;
#endif
}
