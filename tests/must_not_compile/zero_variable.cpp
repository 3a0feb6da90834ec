#include <titop/blocks/spring_mass.hpp>

// A variable is not the literal 0, even if its value is 0.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z1.parent.accel = 0;
  int zero = 0;
  static_cast<void>(zero);
#ifdef MUST_NOT_COMPILE
  z2.parent.accel = zero;
#endif
}
