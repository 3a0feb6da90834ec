// The diagram of the generated model.
#include <titop/titop.hpp>

titop::Diagram oscillator() {
  titop::Diagram d{"oscillator"};
  auto u = d.input("u");
  auto z = d.add("z", titop::SpringMass{.mass = 2.0, .stiffness = 8.0, .damping = 0.1});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  return d;
}
