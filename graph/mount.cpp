#include <titop/graph/mount.hpp>

namespace titop::detail {
namespace {

/// Name of the frame that the signal is in, "" where it has none.
std::string frame_of(const SignalRef& s) {
  if (!s.graph() || s.signal() < 0) return {};
  const int frame = s.graph()->signals[static_cast<std::size_t>(s.signal())].frame;
  return frame < 0 ? std::string{} : s.graph()->nodes[static_cast<std::size_t>(frame)].name;
}

struct Writer : SignalRef {
  explicit Writer(const SignalRef& s) : SignalRef(s) {}
  using SignalRef::set;
};

}  // namespace

void mount(SignalRef child_accel, SignalRef child_force, SignalRef site_accel, SignalRef site_force,
           const Rotation& T_ba, const std::source_location& at, double sign) {
  const std::string a = frame_of(child_accel), b = frame_of(site_accel);
  const bool scalar = a.empty() && b.empty();
  const Rotation T = T_ba.to().empty() && T_ba.from().empty() ? T_ba.named(b, a) : T_ba;
  const Expr motion = scalar ? site_accel.expr() : T.inverse() * site_accel;
  const Expr wrench = scalar ? child_force.expr() : T * child_force;
  Writer(child_accel).set(Rhs(motion, at), /*accumulate=*/false, 1);
  Writer(site_force).set(Rhs(wrench, at), /*accumulate=*/true, sign);
}

void drive_by_zero(SignalRef signal, bool accumulate, const std::source_location& at) {
  Writer(signal).set(Rhs(Expr{}, at), accumulate, 1);
}

}  // namespace titop::detail
