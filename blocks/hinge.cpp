#include <titop/blocks/hinge.hpp>
#include <titop/blocks/joint_block.hpp>

namespace titop {

Hinge::Handle::Handle(Graph* graph, int node)
    : child(graph, node),
      parent(detail::channel<6>(graph, node, 1)),
      accel(detail::channel<1>(graph, node, 2).accel),
      torque(detail::channel<1>(graph, node, 2).force),
      angle(graph, detail::port_signal(*graph, node, "angle")),
      rate(graph, detail::port_signal(*graph, node, "rate")) {}

BlockPtr as_block(const Hinge& spec) {
  return joint_block("Hinge", {about(spec.axis)}, {{"", "torque", "angle", "rate"}},
                     "inertia about its axis");
}

}  // namespace titop
