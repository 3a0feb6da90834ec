#include <fmt/format.h>

#include <Eigen/Geometry>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/joint_block.hpp>

namespace titop {
namespace {

std::vector<AxisNames> names_of(const std::vector<Axis>& axes) {
  std::vector<AxisNames> names;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string name = axes[i].name.empty() ? fmt::format("axis{}", i + 1) : axes[i].name;
    names.push_back({name, "force", name, name + "_rate"});
  }
  return names;
}

}  // namespace

Joint::Handle::Handle(Graph* graph, int node)
    : child(graph, node), parent(detail::channel<6>(graph, node, 1)), graph_(graph), node_(node) {}

Joint::AxisPorts Joint::Handle::axis(std::string_view name) const {
  const Node& node = graph_->nodes[static_cast<std::size_t>(node_)];
  const auto& channels = node.block->interface().channels;
  std::string known;
  for (std::size_t i = 2; i < channels.size(); ++i) {
    known += (known.empty() ? "" : ", ") + channels[i].name;
    if (channels[i].name != name) continue;
    const DualPort<1> port = detail::channel<1>(graph_, node_, static_cast<int>(i));
    return {port.accel, port.force, Reading(graph_, detail::port_signal(*graph_, node_, name)),
            Reading(graph_, detail::port_signal(*graph_, node_, std::string(name) + "_rate"))};
  }
  throw Error(Code::unknown_name, fmt::format("{} has no axis \"{}\"", node.name, name),
              "its axes are: " + known);
}

BlockPtr as_block(const Joint& spec) {
  return joint_block("Joint", spec.axes, names_of(spec.axes), "mass and inertia along its axes");
}

std::vector<Axis> ball() {
  return {about({1, 0, 0}, "rx"), about({0, 1, 0}, "ry"), about({0, 0, 1}, "rz")};
}

std::vector<Axis> universal(const Vector3d& r1, const Vector3d& r2) {
  return {about(r1), about(r2)};
}

std::vector<Axis> cylindrical(const Vector3d& r) { return {along(r, "travel"), about(r, "angle")}; }

std::vector<Axis> planar(const Vector3d& normal) {
  const Vector3d n = unit_direction(about(normal));
  Eigen::Index least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vector3d across = n.cross(Vector3d::Unit(least)).normalized();
  return {along(across), along(n.cross(across)), about(n, "angle")};
}

void detail::release_axes(const Joint::Handle& joint, const Joint& spec, const SourceLine& at) {
  for (const AxisNames& n : names_of(spec.axes))
    drive_by_zero(joint.axis(n.channel).force, /*accumulate=*/true, at);
}

}  // namespace titop
