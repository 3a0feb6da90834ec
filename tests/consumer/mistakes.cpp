// The five likeliest mistakes: each must be refused with its code. The printed text is for reading.
#include <cstdio>
#include <functional>
#include <titop/titop.hpp>
using namespace titop;

const RigidBody hub{.mass = 100.0, .children = {{.name = "C1", .PC = {1, 0, 0}}}};
const RigidBody wing{.mass = 10.0};

Diagram mount_forgotten() {
  Diagram d{"mount forgotten"};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  d.add("A1", wing);
  B.parent.force = -U;
  d.output("xdd_P", 6) = B.parent.accel;
  return d;
}

Diagram force_driven_twice() {
  Diagram d{"force driven twice"};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  B.parent.force = U;
  d.output("xdd_P", 6) = B.parent.accel;
  return d;
}

Diagram frames_mixed() {
  Diagram d{"frames mixed"};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  auto A1 = d.add("A1", wing);
  B.parent.force = -U;
  A1.parent.accel = B.child("C1").accel;
  B.child("C1").force = A1.parent.force;
  d.output("xdd_P", 6) = B.parent.accel;
  return d;
}

Diagram massless_body_freed() {
  Diagram d{"massless body freed"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1.0, .stiffness = 10.0});
  z1.parent.force = -u;
  d.output("xdd") = z1.parent.accel;
  return d;
}

Diagram wrong_size() {
  Diagram d{"wrong size"};
  auto U = d.input("U", 3);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  d.output("xdd_P", 6) = B.parent.accel;
  return d;
}

int main() {
  struct Case {
    Code code;
    std::function<Diagram()> scene;
  };
  const Case cases[] = {{Code::no_equation, mount_forgotten},
                        {Code::two_equations, force_driven_twice},
                        {Code::frame, frames_mixed},
                        {Code::improper, massless_body_freed},
                        {Code::size, wrong_size}};
  int missed = 0;
  for (const Case& mistake : cases) {
    try {
      compile(mistake.scene());
      std::printf("not refused\n\n");
      ++missed;
    } catch (const Error& error) {
      std::printf("%s\n\n", error.what());
      missed += !error.has(mistake.code);
    }
  }
  return missed;
}
