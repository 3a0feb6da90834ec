#pragma once

#include <doctest/doctest.h>

#include <functional>

#include "lft/n17.hpp"

/// Scenes with one parameter p, and the check of its occurrences.
namespace lft_test {

/// The counts of parameter p; that the LFT equals `update` at random values.
inline void check_one(const System& system, const ParameterRange& range, int size, int at_least) {
  const Lft f = lft(system, {{"p", range}});
  const Delta& d = f.deltas()[0];
  INFO(to_string(f), " margin ", f.rank_margin().kept, " ", f.rank_margin().dropped);
  CHECK(f.not_decided() == "");
  CHECK(d.size == size);
  CHECK(d.at_least == at_least);
  CHECK(d.minimal() == (size == at_least));
  for (const double delta : {-0.9, -0.3, 0.5, 0.99}) {
    const double p = d.map.value(delta);
    const std::complex<double> s{0.2, 1.7};
    const Eigen::MatrixXcd G = system.update({{"p", p}}).transfer(s);
    CHECK((f.at({{"p", p}}).transfer(s) - G).norm() <= 1e-12 * G.norm());
  }
}

inline void check_one(const System& system, const ParameterRange& range, int least) {
  check_one(system, range, least, least);
}

inline const Vector3d kPA(0.1, -0.2, 0.3), kPC(0.7, 0.4, -0.3);

/// Two bodies: of the first, free, the wrench is the input; `second` hangs on it.
inline System two_bodies(const RigidBody& first, const RigidBody& second, Diagram d,
                         const Rotation& T = {}) {
  auto hub = d.add("hub", first), tip = d.add("tip", second);
  hub.parent.force = -d.input("U", 6);
  mount(tip, hub.child, T);
  d.output("y", 6) = hub.parent.accel;
  return compile(d);
}

inline RigidBody hub() {
  return {.mass = 9,
          .inertia = (Matrix3d() << 5, 0.5, -0.25, 0.5, 6, 0.75, -0.25, 0.75, 7).finished(),
          .PA = kPA,
          .children = {{"C", kPC}}};
}

inline System with_tip(const std::function<RigidBody(const Param&)>& tip, double nominal) {
  Diagram d{"scene"};
  const Param p = d.param("p", nominal);
  return two_bodies(hub(), tip(p), std::move(d), Rotation::about({0, 0, 1}, 0.5));
}

inline ModalData boom() {
  ModalData data;
  data.omega = Vector3d(2, 5, 9);
  data.xi = Vector3d(0.01, 0.02, 0.03);
  data.L_P = Eigen::MatrixXd::Zero(3, 6);
  data.L_P << 0.2, 1, 0.3, -0.1, 0.2, 0.9, 0.1, -0.2, 0.8, 0.3, -0.5, 0.1, 0.5, 0.1, 0.2, 0.4, 0, 0;
  data.D_P = rigid_mass(6, 4 * Matrix3d::Identity(), Vector3d(-0.5, 0, 0));
  return data;
}

}  // namespace lft_test
