#include <fmt/format.h>

#include <algorithm>
#include <titop/graph/mount.hpp>

namespace titop::detail {
namespace {

/// Name of the frame that the signal is in, "" if it has none.
std::string frame_of(const SignalRef& s) {
  if (!s.graph() || s.signal() < 0) return {};
  const int frame = s.graph()->signals[static_cast<std::size_t>(s.signal())].frame;
  return frame < 0 ? std::string{} : s.graph()->nodes[static_cast<std::size_t>(frame)].name;
}

struct SettableSignal : SignalRef {
  explicit SettableSignal(const SignalRef& s) : SignalRef(s) {}
  using SignalRef::set;
};

/// The force of a body's parent port acts from the body on its surroundings; that of every other
/// port acts on the body.
bool is_parent(const SignalRef& s) {
  if (!s.graph() || s.signal() < 0) return false;
  const Graph& g = *s.graph();
  const int channel = g.signals[static_cast<std::size_t>(s.signal())].channel;
  if (channel < 0) return false;
  const Channel& c = g.channels[static_cast<std::size_t>(channel)];
  const auto& specs = g.nodes[static_cast<std::size_t>(c.node)].block->interface().channels;
  return specs[static_cast<std::size_t>(c.spec)].name == "parent";
}

}  // namespace

void mount(SignalRef child_accel, SignalRef child_force, SignalRef site_accel, SignalRef site_force,
           const Rotation& T_ba, const SourceLine& at, double sign) {
  const std::string a = frame_of(child_accel), b = frame_of(site_accel);
  const bool scalar = a.empty() || b.empty();  // no axes to rotate, or one axis of a frame
  const Rotation T = T_ba.nameless() ? T_ba.named(b, a) : T_ba;
  const Expr motion = scalar ? site_accel.expr() : T.inverse() * site_accel;
  const Expr wrench = scalar ? child_force.expr() : T * child_force;
  SettableSignal(child_accel).set(Rhs(motion, at), /*accumulate=*/false, 1);
  // `sign` is right between a child point as site and, for a weld, another child point.
  const bool turned = is_parent(site_force) != (sign < 0 && is_parent(child_force));
  SettableSignal(site_force).set(Rhs(wrench, at), /*accumulate=*/true, turned ? -sign : sign);
}

Rotation to_joint(const Rotation& T_ba, const SignalRef& body_accel, const std::string& joint,
                  const SourceLine& at) {
  if (T_ba.nameless()) return T_ba;
  const std::string body = frame_of(body_accel);
  const auto is_it = [&](const Node& node) { return node.name == T_ba.from(); };
  Graph* graph = body_accel.graph();
  // A name that no block has is no frame's: nothing to compare, as in other equations.
  const bool fits = !graph || T_ba.from().empty() || T_ba.from() == body || T_ba.from() == joint ||
                    !std::any_of(graph->nodes.begin(), graph->nodes.end(), is_it);
  if (fits) return T_ba.named(T_ba.to(), joint);
  graph->mistakes.push_back(
      {Code::frame,
       fmt::format("{} takes a rotation from {} to {}, but carries {}", joint, T_ba.from(),
                   T_ba.to().empty() ? "a frame without a name" : T_ba.to(),
                   body.empty() ? "without a frame" : body),
       {"written at " + to_string(at)},
       !body.empty() && T_ba.to() == body
           ? fmt::format("exchange its two names: named(\"{}\", \"{}\")", T_ba.from(), body)
           : "give the rotation of the mounted body, or a rotation without names"});
  return T_ba.named({}, {});  // already reported
}

void drive_by_zero(SignalRef signal, bool accumulate, const SourceLine& at) {
  SettableSignal(signal).set(Rhs(Expr{}, at), accumulate, 1);
}

}  // namespace titop::detail
