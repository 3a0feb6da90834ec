#include <titop/blocks/joint_block.hpp>
#include <titop/blocks/slide.hpp>

namespace titop {

Slide::Handle::Handle(Graph* graph, int node)
    : child(graph, node),
      parent(detail::channel<6>(graph, node, 1)),
      accel(detail::channel<1>(graph, node, 2).accel),
      force(detail::channel<1>(graph, node, 2).force),
      travel(graph, detail::port_signal(*graph, node, "travel")),
      rate(graph, detail::port_signal(*graph, node, "rate")) {}

BlockPtr as_block(const Slide& spec) {
  return joint_block("Slide", {along(spec.axis)}, {{"", "force", "travel", "rate"}}, "mass");
}

}  // namespace titop
