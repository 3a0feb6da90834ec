#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Free rotors with momenta on a free rigid hub: orders by the conservation of momentum, by hand.
///
///     J w' + sum I_a a_i nu_i' + w x H = U,   I_a (a_i' w' + nu_i') = u_i - c nu_i,   H = sum h_i
///     a_i

using namespace titop;

namespace {

struct FreeRotors {
  std::vector<Vector3d> axes;
  std::vector<double> h;  ///< of each rotor [N m s]
  double friction = 0;    ///< [N m s/rad]
  Vector3d at{0.25, 0.5, -0.125};
  bool apart = false;  ///< each at a point of its own, in a frame of its own
};

/// Inputs: torque on the hub, or of the motors. Outputs: rates of the hub, its angular
/// accelerations, speeds of the rotors.
struct Asked {
  bool torque = false, motors = false, rates = false, accels = false, speeds = false;
};

System system_of(const FreeRotors& rotors, const Asked& asked) {
  Diagram d{"rotors"};
  RigidBody body{.mass = 100, .inertia = Vector3d(4, 5, 7).asDiagonal(), .children = {}};
  for (std::size_t i = 0; i < (rotors.apart ? rotors.axes.size() : 1); ++i)
    body.children.push_back(
        {"R" + std::to_string(i), (1 + 0.3 * static_cast<double>(i)) * rotors.at});
  auto hub = d.add("hub", body);
  release(hub);
  if (asked.torque) hub.parent.force.angular += -d.input("U", 3);
  for (std::size_t i = 0; i < rotors.axes.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    const Rotation turned =
        rotors.apart ? Rotation::about({1, 2, 3}, 0.3 + static_cast<double>(i)) : Rotation();
    auto rotor = d.add("r" + number, Rotor{.mass = 2,
                                           .axial = 0.25,
                                           .transverse = 0.1875,
                                           .axis = turned.nominal().transpose() * rotors.axes[i],
                                           .momentum = rotors.h[i]});
    mount(rotor, hub.child("R" + std::to_string(rotors.apart ? i : 0)), turned);
    rotor.torque = rotors.friction * rotor.speed;
    if (asked.motors) rotor.torque += -d.input("u" + number);
    if (asked.speeds) d.output("speed" + number) = rotor.speed;
  }
  if (asked.rates) d.output("rate", 3) = hub.parent.rate.angular();
  if (asked.accels) d.output("accel", 3) = hub.parent.accel.angular;
  return compile(d);
}

void check_order(const FreeRotors& rotors, const Asked& asked, int order) {
  const OrderVerdict verdict = [&] {
    const System system = system_of(rotors, asked);
    return system.order_verdict();
  }();
  CAPTURE(to_string(verdict));
  CHECK(verdict.order == order);
  CHECK(verdict.decided());
}

/// k rotors about axes of no symmetry.
FreeRotors skew(int count, double friction) {
  const std::vector<Vector3d> axes = {{1, 2, 2}, {-2, 1, 2}, {2, 2, -1}, {1, 0.5, -1}};
  return {{axes.begin(), axes.begin() + count}, {3, 4, 5, 6}, friction};
}

/// Four rotors whose momenta sum to 0, exactly.
FreeRotors balanced(double friction) {
  return {{{3, 0, 4}, {-3, 0, 4}, {0, 3, -4}, {0, -3, -4}}, {5, 5, 5, 5}, friction};
}

/// Rotors whose momenta sum to 0 but for the last digits of h.
FreeRotors balanced_by_numbers(double friction, bool apart) {
  FreeRotors r = skew(4, friction);
  const auto det = [&](int i, int j, int k) {  // of the unit vectors
    const auto a = [&](int n) { return r.axes[static_cast<std::size_t>(n)].normalized(); };
    return a(i).cross(a(j)).dot(a(k));
  };
  const double scale = -r.h[3] / det(0, 1, 2);  // Cramer's rule
  r.h = {scale * det(3, 1, 2), scale * det(0, 3, 2), scale * det(0, 1, 3), r.h[3]};
  r.apart = apart;
  return r;
}

}  // namespace

TEST_CASE("rotors: momenta that sum to 0 up to rounding are 0, wherever the rotors are") {
  for (const double friction : {0.0, 0.125})
    for (const bool apart : {false, true}) {
      CAPTURE(friction);
      CAPTURE(apart);
      const FreeRotors rotors = balanced_by_numbers(friction, apart);
      check_order(rotors, {.motors = true, .rates = true, .speeds = true}, 4);
      if (friction == 0) check_order(rotors, {.torque = true, .accels = true}, 0);
    }
  FreeRotors pairs{{{0.1, 0.2, 0.97}, {-0.1, -0.2, -0.97}, {0.3, 0.7, 0.1}, {-0.3, -0.7, -0.1}},
                   {5, 5, 5, 5}};
  for (const bool apart : {false, true}) {
    pairs.apart = apart;
    // Two axes: the motors turn the hub in their plane, a wheel follows from its opposite.
    check_order(pairs, {.motors = true, .rates = true, .speeds = true}, 4);
  }
}

TEST_CASE("rotors: torques on the hub and of motors reach all rates, speeds see them") {
  for (const int count : {1, 2, 3, 4})
    for (const double friction : {0.0, 0.125}) {
      CAPTURE(count);
      CAPTURE(friction);
      check_order(skew(count, friction),
                  {.torque = true, .motors = true, .rates = true, .speeds = true}, 3 + count);
    }
}

TEST_CASE("rotors: motors alone keep the momentum along H, all of it if H is 0") {
  for (const double friction : {0.0, 0.125}) {
    CAPTURE(friction);
    const Asked asked{.motors = true, .rates = true, .speeds = true};
    for (const int count : {1, 2, 3, 4}) {
      CAPTURE(count);
      check_order(skew(count, friction), asked, 3 + count - 1);
    }
    // Momenta that sum to 0, and no momenta: the hub's rates follow from the speeds.
    check_order(balanced(friction), asked, 4);
    check_order({skew(3, friction).axes, {0, 0, 0}, friction}, asked, 3);
    // About a principal axis a rotor turns the hub about no other.
    check_order({{Vector3d(0, 0, 1)}, {5}, friction, Vector3d::Zero()},
                {.motors = true, .rates = true}, 1);
  }
}

TEST_CASE("rotors: free ones follow the hub's rates, through friction about the axes they span") {
  const Asked asked{.torque = true, .rates = true, .speeds = true};
  for (const int count : {1, 2, 3, 4}) {
    CAPTURE(count);
    check_order(skew(count, 0), asked, 3);
    check_order(skew(count, 0.125), asked, 3 + std::min(count, 3));
  }
}

TEST_CASE("rotors: accelerations see the rates across H alone, and none without momenta") {
  const Asked asked{.torque = true, .accels = true};
  for (const int count : {1, 2, 3, 4}) {
    CAPTURE(count);
    check_order(skew(count, 0), asked, 2);
  }
  check_order(balanced(0), asked, 0);
  check_order({skew(3, 0).axes, {0, 0, 0}, 0}, asked, 0);
}
