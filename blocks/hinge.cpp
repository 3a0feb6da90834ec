#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/hinge.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;

const Interface& face() {
  static const Interface shared{{{"child", 6, Takes::force},
                                 {"parent", 6, Takes::accel},
                                 {"", 1, Takes::accel, "accel", "torque"}},
                                {},
                                {{"angle", 1, Quantity::position}, {"rate", 1, Quantity::velocity}},
                                {"angle", "rate"}};
  return shared;
}

class HingeBlock : public Block {
 public:
  explicit HingeBlock(const Vector3d& r) : r_(r) {
    auto d = std::make_shared<Dynamics>();
    d->A = (MatrixXd(2, 2) << 0, 1, 0, 0).finished();
    d->B = MatrixXd::Zero(2, 13);
    d->B(1, 12) = 1;
    d->C = MatrixXd::Zero(15, 2);
    d->C(13, 0) = d->C(14, 1) = 1;
    d->D = MatrixXd::Zero(15, 13);
    d->D.block<6, 6>(0, 6).setIdentity();     // xdd_C from xdd_P
    d->D.block<3, 1>(3, 12) = r;              //        from thetadd
    d->D.block<6, 6>(6, 0).setIdentity();     // F_P from F_C
    d->D.block<1, 3>(12, 3) = r.transpose();  // C_m from T_C
    matrices_ = std::move(d);
  }
  std::string_view type() const override { return "Hinge"; }
  const Interface& interface() const override { return face(); }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }
  Pattern feedthrough() const override {
    Pattern p = matrices_->D.array() != 0;
    p.block<3, 1>(3, 12).setConstant(true);  // whatever the axis
    p.block<1, 3>(12, 3).setConstant(true);
    return p;
  }
  /// Only its own axis moves the angle, and only angle and rate show it: at a given posture the
  /// accelerations and wrenches on both sides know nothing of them.
  Pattern moved_by() const override {
    Pattern p = Pattern::Constant(1, 13, false);
    p(0, 12) = true;
    return p;
  }
  Pattern seen_by() const override {
    Pattern p = Pattern::Constant(15, 1, false);
    p(13, 0) = p(14, 0) = true;
    return p;
  }
  std::optional<Kinematics> kinematics(ParameterValues) const override {
    Kinematics k{.reference = 1, .tau = {}, .Phi = {}};
    k.tau = {MatrixXd::Identity(6, 6), MatrixXd::Identity(6, 6), MatrixXd::Zero(1, 6)};
    MatrixXd turn = MatrixXd::Zero(6, 2), angle = MatrixXd::Zero(1, 2);
    turn.block<3, 1>(3, 0) = r_;
    angle(0, 0) = 1;
    k.Phi = {turn, MatrixXd::Zero(6, 2), angle};
    return k;
  }
  std::optional<Cause> why_singular(int, ParameterValues) const override {
    return Cause{"is a massless joint",
                 "give the body that it carries inertia about its axis, or drive the other side"};
  }

 private:
  Vector3d r_;
  std::shared_ptr<const Dynamics> matrices_;
};

}  // namespace

Hinge::Handle::Handle(Graph* graph, int node)
    : child(graph, node),
      parent(detail::channel<6>(graph, node, 1)),
      accel(detail::channel<1>(graph, node, 2).accel),
      torque(detail::channel<1>(graph, node, 2).force),
      angle(graph, detail::port_signal(*graph, node, "angle")),
      rate(graph, detail::port_signal(*graph, node, "rate")) {}

BlockPtr as_block(const Hinge& spec) {
  const double length = spec.axis.norm();
  if (!(length > 0) || !std::isfinite(length))
    throw Error(Code::bad_value,
                fmt::format("the axis ({}, {}, {}) has no direction", spec.axis.x(), spec.axis.y(),
                            spec.axis.z()),
                "give a finite vector other than 0");
  return std::make_shared<HingeBlock>(spec.axis / length);
}

}  // namespace titop
