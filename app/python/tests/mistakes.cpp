// The ten likeliest mistakes, as users make them in C++; test_mistakes.py makes the same ones in
// Python. Prints "== NAME" and the text of the error.
#include <cstdio>
#include <functional>
#include <titop/titop.hpp>
using namespace titop;

namespace {

const RigidBody hub{.mass = 100, .children = {{"C1", {1, 0, 0}}}};
const RigidBody wing{.mass = 10};

void mount_forgotten(Diagram& d) {
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  d.add("A1", wing);
  B.parent.force = -U;
  d.output("xdd_P", 6) = B.parent.accel;
}

void force_driven_twice(Diagram& d) {
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  B.parent.force = U;
  d.output("xdd_P", 6) = B.parent.accel;
}

void frames_mixed(Diagram& d) {
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  auto A1 = d.add("A1", wing);
  B.parent.force = -U;
  A1.parent.accel = B.child("C1").accel;
  B.child("C1").force = A1.parent.force;
  d.output("xdd_P", 6) = B.parent.accel;
}

void massless_body_freed(Diagram& d) {
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 10});
  z1.parent.force = -u;
  d.output("xdd") = z1.parent.accel;
}

void wrong_size(Diagram& d) {
  auto U = d.input("U", 3);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  d.output("xdd_P", 6) = B.parent.accel;
}

void unknown_child(Diagram& d) {
  auto B = d.add("B", hub);
  auto A1 = d.add("A1", wing);
  B.parent.force = 0;
  mount(A1, B.child("C2"));
  d.output("xdd_P", 6) = B.parent.accel;
}

void name_taken(Diagram& d) {
  auto B = d.add("B", hub);
  auto A1 = d.add("B", wing);
  B.parent.force = 0;
  mount(A1, B.child("C1"));
  d.output("xdd_P", 6) = B.parent.accel;
}

void position_as_acceleration(Diagram& d) {
  auto z1 = d.add("z1", SpringMass{.mass = 1, .stiffness = 10});
  auto z2 = d.add("z2", SpringMass{.mass = 1, .stiffness = 10});
  ground(z1);
  z2.parent.accel = z1.stretch;
  z1.child.force = z2.parent.force;
  d.output("x") = z2.stretch;
}

void hinge_not_driven(Diagram& d) {
  auto B = d.add("B", hub);
  auto A1 = d.add("A1", wing);
  B.parent.force = 0;
  hinge(d, "drive", A1, B.child("C1"), Rotation(), {0, 0, 1});
  d.output("xdd_P", 6) = B.parent.accel;
}

void negative_mass(Diagram& d) { d.add("B", RigidBody{.mass = -1}); }

}  // namespace

int main() {
  const std::pair<const char*, std::function<void(Diagram&)>> cases[] = {
      {"mount_forgotten", mount_forgotten},
      {"force_driven_twice", force_driven_twice},
      {"frames_mixed", frames_mixed},
      {"massless_body_freed", massless_body_freed},
      {"wrong_size", wrong_size},
      {"unknown_child", unknown_child},
      {"name_taken", name_taken},
      {"position_as_acceleration", position_as_acceleration},
      {"hinge_not_driven", hinge_not_driven},
      {"negative_mass", negative_mass}};
  for (const auto& [name, write] : cases) {
    try {
      Diagram d{"scene"};
      write(d);
      compile(d);
      return 1;
    } catch (const Error& error) {
      std::printf("== %s\n%s\n", name, error.what());
    }
  }
}
