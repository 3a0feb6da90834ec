#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <titop/titop.hpp>

#include "support/five_masses.hpp"
#include "support/rng.hpp"

// The model does not depend on the order in which a scene is written, to the last bit: rows and
// columns follow the declarations, their entries do not.

using namespace titop;
using namespace titop_test;

namespace {

/// Runs these steps in an order determined by the seed; seed 0: as given.
void run(std::vector<std::function<void()>> steps, unsigned seed) {
  if (seed != 0) Rng(seed).shuffle(steps);
  for (const auto& step : steps) step();
}

StateSpace five(const Five& m, const Five& k, unsigned seed) {
  Diagram d{"five masses"};
  std::map<int, SpringMass::Handle> z;
  std::map<std::string, InputRef> in;
  std::vector<std::function<void()>> adds, equations;
  for (int i = 1; i <= 5; ++i)
    adds.push_back([&, i] {
      const auto at = static_cast<std::size_t>(i - 1);
      z.emplace(i, d.add("z" + std::to_string(i), SpringMass{.mass = m[at], .stiffness = k[at]}));
    });
  for (const char* name : {"u", "v"})
    adds.push_back([&, name] { in.emplace(name, d.input(name)); });
  run(adds, seed);
  const auto z_ = [&](int i) -> SpringMass::Handle& { return z.at(i); };
  equations = {[&] { z_(1).parent.accel = 0; },
               [&] { z_(2).parent.accel = z_(1).child.accel; },
               [&] { z_(3).parent.accel = z_(1).child.accel; },
               [&] { mount(z_(4), z_(2).child); },
               [&] { mount(z_(5), z_(2).child); },
               [&] { z_(1).child.force += z_(2).parent.force; },
               [&] { z_(1).child.force += z_(3).parent.force; },
               [&] { z_(1).child.force -= 0.3 * in.at("u"); },
               [&] { z_(1).child.force += 0.7 * in.at("v"); },
               [&] { z_(2).child.force += in.at("u"); },
               [&] { d.output("x3") = z_(3).position; },
               [&] { d.output("a4") = z_(4).child.accel; }};
  run(equations, seed * 7);
  return compile(d).state_space();
}

StateSpace satellite(unsigned seed) {
  Diagram d{"satellite"};
  ModalData data;
  data.omega = Eigen::Vector3d(2, 5, 11);
  data.xi = Eigen::Vector3d(0.01, 0.02, 0.03);
  data.L_P = Eigen::MatrixXd::Zero(3, 6);
  data.L_P << 0.1, 1.2, 0.3, -0.2, 0.5, 0.9, 0.7, -0.4, 0.6, 0.3, -0.8, 0.1, 0.2, 0.1, -0.9, 0.4,
      0.3, 0.2;
  data.D_P = rigid_mass(9, Vector3d(4, 5, 6).asDiagonal(), {-0.5, 0, 0.1});
  data.children.push_back({"F", {2, 0, 0.3}, 0.1 * Eigen::MatrixXd::Ones(6, 3)});
  const FlexibleBody wing(data);
  const RigidBody hub{.mass = 70,
                      .inertia = Vector3d(20, 30, 40).asDiagonal(),
                      .PA = {0.1, 0, -0.2},
                      .children = {{"C1", {1, 0, 0}}, {"C2", {-1, 0.1, 0}}}};
  std::map<std::string, BodyHandle> body;
  std::map<std::string, InputRef> in;
  std::map<std::string, Hinge::Handle> joint;
  std::map<std::string, Integrator::Handle> sum;
  run({[&] { body.emplace("hub", d.add("hub", hub)); },
       [&] { body.emplace("wing2", d.add("wing2", wing)); },
       [&] { body.emplace("wing10", d.add("wing10", wing)); },
       [&] {
         joint.emplace("h", d.add("h", Hinge{{0, 1, 0}}));
       },
       [&] { sum.emplace("I", d.add("I", Integrator{})); },
       [&] { in.emplace("U", d.input("U", 6)); }, [&] { in.emplace("t", d.input("t")); }},
      seed);
  const Rotation T1 = Rotation::about({1, 2, 3}, 0.4), T2 = Rotation::about({0, 1, 3}, 2.4);
  BodyHandle &B = body.at("hub"), &W2 = body.at("wing2"), &W10 = body.at("wing10");
  Hinge::Handle& h = joint.at("h");
  Integrator::Handle& I = sum.at("I");
  run({[&] { B.parent.force.linear = Eigen::MatrixXd::Identity(3, 6) * in.at("U"); },
       [&] { B.parent.force.angular = 0.1 * B.parent.accel.angular; },
       [&] { B.parent.force -= in.at("U"); }, [&] { mount(W2, B.child("C1"), T1); },
       [&] { mount(h, B.child("C2"), T2); }, [&] { mount(W10, h.child); },
       [&] { h.torque = 3 * h.angle + 0.1 * h.rate - in.at("t") + I.out; }, [&] { I.in = h.angle; },
       [&] { B.child("C2").force.linear += 0.2 * B.parent.accel.linear; },
       [&] { d.output("a", 6) = B.parent.accel; },
       [&] { d.output("tip", 6) = W10.child("F").accel; }, [&] { d.output("angle") = h.angle; }},
      seed * 13);
  return compile(d).state_space();
}

/// Position of each name of `names` in `among`; all must be there.
std::vector<int> places(const std::vector<std::string>& names,
                        const std::vector<std::string>& among) {
  std::vector<int> result;
  for (const std::string& name : names) {
    const auto it = std::find(among.begin(), among.end(), name);
    REQUIRE(it != among.end());
    result.push_back(static_cast<int>(it - among.begin()));
  }
  return result;
}

/// The same entries under the same names, to the last bit.
void same(const StateSpace& a, const StateSpace& b) {
  const auto x = places(a.states, b.states), u = places(a.inputs, b.inputs),
             y = places(a.outputs, b.outputs);
  REQUIRE(a.order() == b.order());
  CHECK(a.A == b.A(x, x));
  CHECK(a.B == b.B(x, u));
  CHECK(a.C == b.C(y, x));
  CHECK(a.D == b.D(y, u));
}

}  // namespace

TEST_CASE("shuffled: five masses") {
  const StateSpace plain = five(kMasses, kStiffnesses, 0);
  CHECK(plain.order() == 10);
  for (unsigned seed = 1; seed <= 8; ++seed) same(plain, five(kMasses, kStiffnesses, seed));
}

TEST_CASE("shuffled: five masses, where two states are removed by their numbers") {
  const Five m{1, 2, 3, 4, 5}, k{10, 26, 33, 20, 25};
  const StateSpace plain = five(m, k, 0);
  CHECK(plain.order() == 8);
  for (unsigned seed = 1; seed <= 8; ++seed) same(plain, five(m, k, seed));
}

TEST_CASE("shuffled: hub, wings, hinge, controller") {
  const StateSpace plain = satellite(0);
  CHECK(plain.order() == 15);
  for (unsigned seed = 1; seed <= 8; ++seed) same(plain, satellite(seed));
}
