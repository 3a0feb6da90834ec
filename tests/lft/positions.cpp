#include "lft/one_parameter.hpp"

/// The least number of occurrences of positions of ports and of centres of mass.

using namespace lft_test;

TEST_CASE("positions: centre of mass, port, length of a rigid boom") {
  const auto skew = [](Position PA) {
    return RigidBody{.mass = 2, .inertia = {3, 4, 5, 0.5, 0.25, 0}, .PA = PA};
  };
  check_one(with_tip([&](const Param& p) { return skew({0.1, p, 0.3}); }, 0.5), between(-1, 2), 4);
  check_one(with_tip(
                [&](const Param& p) {
                  return skew({p, 2 * p, -1 * p});
                },
                0.5),
            between(-1, 2), 4);
  const auto with_port = [](const std::function<Position(const Param&)>& PC, const RigidBody& tip) {
    Diagram d{"port"};
    RigidBody carrier = hub();
    carrier.children = {{"C", PC(d.param("p", 0.7))}};
    return two_bodies(carrier, tip, std::move(d), Rotation::about({0, 0, 1}, 0.5));
  };
  const auto one = [](const Param& p) { return Position(0.2, p, -0.3); };
  check_one(with_port(one, skew(kPA)), between(-1, 2), 4);
  check_one(with_port(one, RigidBody{.mass = 2, .inertia = Matrix3d::Zero()}), between(-1, 2), 4);
  check_one(with_port([](const Param& p) { return Position(p, -1 * p, 0.5 * p); }, skew(kPA)),
            between(-1, 2), 4);
}

TEST_CASE("a mass and the position of its centre together") {
  Diagram d{"both"};
  const Param m = d.param("m", 3), x = d.param("x", 0.2);
  const System system = two_bodies(
      hub(), RigidBody{.mass = m, .inertia = {3, 4, 5, 0.5, 0.25, 0}, .PA = {x, 0.1, 0.4}},
      std::move(d), Rotation::about({0, 0, 1}, 0.5));
  const Lft f = lft(system, {{"m", percent(60)}, {"x", between(-1, 1.5)}});
  INFO(to_string(f));
  CHECK(f.deltas()[0].size == 3);
  CHECK(f.deltas()[1].size == 4);
  CHECK(f.deltas()[0].minimal());
  CHECK(f.deltas()[1].minimal());
  for (const auto& [mass, place] : {std::pair(1.5, -0.9), {4.5, 1.4}, {3.0, 0.7}}) {
    const ParameterList values = {{"m", mass}, {"x", place}};
    const Eigen::MatrixXcd G = system.update(values).transfer({0.2, 1.7}, Precision::digits50);
    CHECK((f.at(values).transfer({0.2, 1.7}) - G).norm() <= 1e-12 * G.norm());
  }
}

TEST_CASE("a position read beyond a port that moves, and a law that uses it") {
  // Rate and position of the tip: through the moved port to the hub's own Integrators.
  Diagram d{"read"};
  const Param p = d.param("p", 0.7);
  RigidBody carrier = hub();
  carrier.children = {{"C", {0.2, p, 2 * p}}, {"D", {0, 0, 1}}};
  auto b = d.add("hub", carrier);
  auto arm = d.add("arm", RigidBody{.mass = 2, .PA = kPA, .children = {{"E", {-1 * p, 0.1, 0.2}}}});
  auto tip = d.add("tip", FlexibleBody{boom()});
  const Rotation to_hub = Rotation::about({0, 0, 1}, 0.5),
                 to_arm = Rotation::about({1, 0, 0}, -0.3);
  mount(arm, b.child("C"), to_hub);
  mount(tip, arm.child, to_arm);
  b.parent.force = -d.input("U", 6);
  b.child("D").force +=
      -1.0 * (2.0 * b.child("C").rate + 3.0 * (to_hub * (to_arm * tip.parent.position)));
  d.output("rate", 6) = tip.parent.rate;
  d.output("place", 6) = tip.parent.position;
  d.output("linear", 3) = arm.child("E").position.linear();
  const System system = compile(d);
  const Lft f = lft(system, {{"p", between(-1, 2)}});
  INFO(to_string(f));
  CHECK(f.deltas()[0].at_least <= f.deltas()[0].size);
  for (const double value : {-0.9, 0.0, 0.4, 1.9}) {
    const Eigen::MatrixXcd G =
        system.update({{"p", value}}).transfer({0.2, 1.7}, Precision::digits50);
    CHECK((f.at({{"p", value}}).transfer({0.2, 1.7}) - G).norm() <= 1e-12 * G.norm());
  }
}
