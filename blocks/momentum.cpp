#include <titop/blocks/momentum.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {

void momentum(const DualPort<6>& port, const Value& h, const Vector3d& axis,
              std::source_location at) {
  const Vector3d a = unit_direction(about(axis));
  const Graph* g = port.accel.graph();
  if (!g)
    throw Error(Code::unknown_name, "momentum: the port is of no diagram",
                "pass a port of a body that has been added: hub.parent, hub.child(\"C\")");
  const bool exists = port.accel.signal() >= 0;  // else the mistake is noted by `+=`
  const bool outward =
      exists && is_outward(*g, g->signals[linalg::at(port.accel.signal())].channel);
  const Value push = outward ? -h : h;
  const auto [b, c] = across(a);  // a x omega = c (b' omega) - b (c' omega)
  port.force.angular.along(c) += Rhs(push * port.rate.angular().along(b), at);
  port.force.angular.along(b) += Rhs(-push * port.rate.angular().along(c), at);
}

}  // namespace titop
