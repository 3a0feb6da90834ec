#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/mount.hpp>

// One axis of a point carries blocks of one axis; a body needs all six.
void scene() {
  using namespace titop;
  Diagram d{"scene"};
  auto hub = d.add("hub", RigidBody{.children = {{"C"}}});
  auto body = d.add("body", RigidBody{});
  auto z = d.add("z", SpringMass{});
  mount(z, hub.child.along({1, 0, 0}));
  mount(body, hub.child);
#ifdef MUST_NOT_COMPILE
  mount(body, hub.child.along({1, 0, 0}));
#endif
}
