#pragma once

#include "by_hand.hpp"

/// A wheel on a hub through bushings whose axes are coupled; by hand, too.
namespace scenes_test {

struct IsolatedWheel {
  bool two = false;  ///< a second bushing between both bodies: the chain is closed
  bool damped = false;

  static constexpr double kHub = 10, kWheel = 2;  // [kg]
  const Eigen::Vector3d turn{1, 2, -1}, site{1, 0.2, 0}, centre{0.1, 0.2, 0.1}, rim{0.3, 0, -0.1},
      second{-0.2, 0.1, 0.3};
  const Eigen::Vector3d hub_inertia{1, 1.5, 2}, wheel_inertia{0.2, 0.25, 0.3};
  static constexpr double kAngle = 0.7;

  Eigen::Matrix3d T() const {
    return Eigen::AngleAxisd(kAngle, turn.normalized()).toRotationMatrix();
  }
  /// Of springs at an elastic centre off the bushing, and a term of its own.
  by_hand::Matrix6 stiffness() const {
    const VectorXd k = (VectorXd(6) << 4e4, 5e4, 9e4, 300, 400, 100).finished();
    const by_hand::Matrix6 t = by_hand::tau({0.02, -0.05, 0.03});
    by_hand::Matrix6 K = t.transpose() * k.asDiagonal() * t;
    K(1, 5) += 500, K(5, 1) += 500;
    return K;
  }
  /// Not proportional to the stiffness.
  by_hand::Matrix6 damping() const {
    const VectorXd c = (VectorXd(6) << 10, 20, 15, 1, 2, 1.5).finished();
    by_hand::Matrix6 C = damped ? by_hand::Matrix6(c.asDiagonal()) : by_hand::Matrix6::Zero();
    if (damped) C(0, 4) = C(4, 0) = 2;
    return C;
  }
  by_hand::Matrix6 second_stiffness() const {
    const by_hand::Matrix6 t = by_hand::tau({0.01, 0.04, 0.02});
    return 0.5 * t.transpose() * stiffness() * t;
  }

  struct Bodies {
    titop::RigidBody::Handle hub, wheel;
  };
  Bodies add(titop::Diagram& d) const {
    auto hub =
        d.add("hub", titop::RigidBody{.mass = kHub,
                                      .inertia = hub_inertia.asDiagonal(),
                                      .children = {{"c", site}, {"c2", site + T() * second}}});
    auto wheel = d.add("wheel", titop::RigidBody{.mass = kWheel,
                                                 .inertia = wheel_inertia.asDiagonal(),
                                                 .PA = centre,
                                                 .children = {{"rim", rim}, {"s", second}}});
    const titop::Rotation mounting = titop::Rotation::about(turn, kAngle);
    bushing(d, "iso", wheel, hub.child("c"), mounting,
            {.stiffness = stiffness(), .damping = damping()});
    if (two)
      bushing(d, "snubber", wheel.child("s"), hub.child("c2"), mounting,
              {.stiffness = second_stiffness()});
    return {hub, wheel};
  }

  /// Coordinates: the hub's parent, then the bushing's displacement. Inputs and outputs: wrenches
  /// and accelerations at the hub's parent and at the rim, each in its body's frame.
  by_hand::Structure by_hand() const {
    by_hand::Structure a = by_hand::empty(12, 12, 12);
    const auto rigid = [](double mass, const Eigen::Vector3d& inertia) {
      VectorXd m(6);
      m << mass, mass, mass, inertia;
      return MatrixXd(m.asDiagonal());
    };
    MatrixXd wheel(6, 12);
    wheel << by_hand::dual(T()).transpose() * by_hand::tau(-site), by_hand::Matrix6::Identity();
    const MatrixXd at_centre = by_hand::tau(-centre) * wheel;
    a.M = at_centre.transpose() * rigid(kWheel, wheel_inertia) * at_centre;
    a.M.topLeftCorner(6, 6) += rigid(kHub, hub_inertia);
    const by_hand::Matrix6 to_second = by_hand::tau(-second);
    a.K.bottomRightCorner(6, 6) = stiffness();
    if (two) a.K.bottomRightCorner(6, 6) += to_second.transpose() * second_stiffness() * to_second;
    a.D.bottomRightCorner(6, 6) = damping();
    a.C.topLeftCorner(6, 6).setIdentity();
    a.C.bottomRows(6) = by_hand::tau(-rim) * wheel;
    a.B = a.C.transpose();
    return a;
  }
};

}  // namespace scenes_test
