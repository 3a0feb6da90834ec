#include <titop/blocks/spring_mass.hpp>

// expect: a signal cannot be divided by a parameter p
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  [[maybe_unused]] const Param p = d.param("p", 2);
  auto z = d.add("z", SpringMass{});
  z.child.force = z.stretch * p;
#ifdef MUST_NOT_COMPILE
  z.parent.force = z.stretch / p;
#endif
}
