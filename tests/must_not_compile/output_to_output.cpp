#include <titop/blocks/spring_mass.hpp>

// An output of the diagram cannot be read back.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto z1 = d.add("z1", SpringMass{});
  auto z2 = d.add("z2", SpringMass{});
  d.output("x") = z1.stretch + z2.stretch;
#ifdef MUST_NOT_COMPILE
  d.output("y") = d.output("x");
#endif
}
