#include <cstdio>
#include <string>
#include <titop/titop.hpp>
using namespace titop;

Diagram five_masses() {  // [Alazard 2015] Fig. 7, Table 1 right
  Diagram d{"five masses"};
  auto u = d.input("u");                                              // actuator force [N]
  auto z1 = d.add("z1", SpringMass{.mass = 1.0, .stiffness = 10.0});  // [kg], [N/m]
  auto z2 = d.add("z2", SpringMass{.mass = 2.0, .stiffness = 26.0});
  auto z3 = d.add("z3", SpringMass{.mass = 3.0, .stiffness = 33.0});
  auto z4 = d.add("z4", SpringMass{.mass = 4.0, .stiffness = 20.0});
  auto z5 = d.add("z5", SpringMass{.mass = 5.0, .stiffness = 95.0});

  z1.parent.accel = 0;  // the wall
  z2.parent.accel = z1.child.accel;
  z3.parent.accel = z1.child.accel;
  z4.parent.accel = z2.child.accel;
  z5.parent.accel = z2.child.accel;
  z1.child.force = z2.parent.force + z3.parent.force - u;
  z2.child.force = z4.parent.force + z5.parent.force + u;

  d.output("x3") = z1.stretch + z3.stretch;  // position of mass 3 [m]
  return d;
}

int main() {
  const System system = compile(five_masses());
  std::printf("order %d\n%s", system.state_space().order(), to_string(system.poles()).c_str());
}
