#include <titop/blocks/spring_mass.hpp>

// A reaction is a result: nothing can be assigned to it.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  z2.child.force = z1.child.reaction;
#ifdef MUST_NOT_COMPILE
  z2.child.reaction = z1.child.reaction;
#endif
}
