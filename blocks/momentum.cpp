#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/momentum.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {

void momentum(const DualPort<6>& port, const Value& h, const Vector3d& axis, SourceLine at) {
  const Graph* g = port.accel.graph();
  if (!g)
    throw Error(Code::unknown_name, "momentum: the port is of no diagram",
                "pass a port of a body that has been added: hub.parent, hub.child(\"C\")");
  const bool exists = port.accel.signal() >= 0;  // else the mistake is noted by `+=`
  const int channel = exists ? g->signals[linalg::at(port.accel.signal())].channel : -1;
  const std::string where = exists ? " at " + channel_name(*g, channel) : "";
  if (!std::isfinite(h.nominal()) || !axis.allFinite())
    throw Error(Code::not_finite, fmt::format("the momentum{} is not finite", where),
                "give a finite h [N m s] and axis");
  if (axis.isZero(0))
    throw Error(Code::bad_value, fmt::format("the axis of the momentum{} has no direction", where),
                "give the axis about which the rotor spins, in the port's frame");
  const Vector3d a = unit_direction(about(axis));
  const bool outward = exists && is_outward(*g, channel);
  const Value push = outward ? -h : h;
  const auto [b, c] = across(a);  // a x omega = c (b' omega) - b (c' omega)
  port.force.angular.along(c) += Rhs(push * port.rate.angular().along(b), at);
  port.force.angular.along(b) += Rhs(-push * port.rate.angular().along(c), at);
}

}  // namespace titop
