#include <titop/blocks/axis.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/slosh.hpp>

namespace titop {

Joint::Handle slosh(Diagram& d, const std::string& name, const DualPort<6>& site, const Slosh& spec,
                    SourceLine at) {
  const auto [b, c] = across(unit_direction(about(spec.axis)));
  auto liquid =
      d.add(name, RigidBody{.mass = spec.mass, .inertia = Matrix3d(Matrix3d::Zero())}, at);
  Joint::Handle springs =
      joint(d, name + " springs", liquid, site, {}, {along(b, "b"), along(c, "c")}, at);
  for (const char* axis : {"b", "c"}) {
    const auto motion = springs.axis(axis);
    motion.force = spec.stiffness * motion.position + spec.damping * motion.rate;
  }
  return springs;
}

}  // namespace titop
