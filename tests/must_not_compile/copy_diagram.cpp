#include <titop/blocks/spring_mass.hpp>

// A diagram moves or is cloned; it is never copied by accident.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  Diagram copy = d.clone();
  z1 = z2;
#ifdef MUST_NOT_COMPILE
  Diagram second = d;
#endif
}
