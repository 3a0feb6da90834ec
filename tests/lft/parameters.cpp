#include "lft/one_parameter.hpp"

/// The least number of occurrences of each kind of parameter, in a scene of its own.

using namespace lft_test;
using Eigen::MatrixXd;

namespace {

System with_boom(const std::function<ModeValues(const Param&)>& values, double nominal) {
  Diagram d{"scene"};
  const Param p = d.param("p", nominal);
  auto b = d.add("hub", hub());
  auto flexible = d.add("boom", FlexibleBody{FlexibleBody{boom()}, values(p)});
  b.parent.force = -d.input("U", 6);
  mount(flexible, b.child);
  d.output("y", 6) = b.parent.accel;
  return compile(d);
}

}  // namespace

TEST_CASE("mass and inertia") {
  check_one(with_tip([](const Param& p) { return RigidBody{.mass = p, .PA = kPA}; }, 3),
            percent(40), 3);
  const auto inertia = [](Value xx, Value xy) {
    return RigidBody{.mass = 2, .inertia = {xx, 4, 5, xy, 0.25, 0}, .PA = kPA};
  };
  check_one(with_tip([&](const Param& p) { return inertia(p, 0.5); }, 3), percent(20), 1);
  check_one(with_tip([&](const Param& p) { return inertia(3, p); }, 0.5), percent(50), 2);
  check_one(with_tip(
                [](const Param& p) {
                  return RigidBody{.mass = 2 * p, .inertia = {3 * p, 4 * p, 5 * p}, .PA = kPA};
                },
                1.5),
            percent(50), 6);
}

TEST_CASE("entries of a controller's matrices") {
  const auto loop = [](const std::vector<Lti::Entry>& values, Diagram d) {
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 7, .damping = 0.1});
    ground(z);
    auto K = d.add("K", Lti{.A = MatrixXd{{-1, 2, 0.5}, {-2, -3, 1}, {0.25, 0, -4}},
                            .B = MatrixXd{{1, 0.5}, {0, 1}, {2, 1}},
                            .C = MatrixXd{{1, -1, 0.5}},
                            .D = MatrixXd{{0.5, 0}},
                            .values = values});
    K.in = MatrixXd{{1}, {0}} * z.stretch + MatrixXd{{0}, {1}} * d.input("r");
    z.child.force = d.input("u") - K.out;
    d.output("x") = z.stretch;
    d.output("c") = K.out;
    return compile(d);
  };
  for (const auto& [matrix, row, column] :
       {std::tuple('A', 2, 1), {'A', 1, 1}, {'B', 3, 2}, {'C', 1, 2}, {'D', 1, 1}}) {
    CAPTURE(matrix);
    Diagram d{"loop"};
    const Lti::Entry entry{matrix, row, column, -2 * d.param("p", 0.75)};
    check_one(loop({entry}, std::move(d)), percent(60), 1);
  }
  Diagram d{"loop"};  // a factor on a row of A: rank 1
  const Param p = d.param("p", 0.5);
  check_one(loop({{'A', 2, 1, -2 * p}, {'A', 2, 2, -3 * p}, {'A', 2, 3, 1 * p}}, std::move(d)),
            percent(60), 1);
}

TEST_CASE("springs, dampers and masses of one axis") {
  const auto chain = [](const std::function<SpringMass(const Param&)>& make, double nominal) {
    Diagram d{"chain"};
    const Param p = d.param("p", nominal);
    auto a = d.add("a", make(p));
    auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 7, .damping = 0.1});
    a.parent.force = -d.input("u");
    mount(b, a.child);
    d.output("y") = a.parent.accel;
    d.output("x") = b.stretch;
    return compile(d);
  };
  const SpringMass fixed{.mass = 3, .stiffness = 8, .damping = 0.2, .parent_mass = 5};
  for (Value SpringMass::*number :
       {&SpringMass::mass, &SpringMass::stiffness, &SpringMass::damping, &SpringMass::parent_mass})
    check_one(chain(
                  [&](const Param& p) {
                    SpringMass z = fixed;
                    z.*number = 2 * p;
                    return z;
                  },
                  (fixed.*number).nominal() / 2),
              percent(60), 1);
}

TEST_CASE("an isolator: one axis, and a factor on all six") {
  const auto isolated = [](const std::function<Bushing(const Param&)>& make) {
    Diagram d{"isolator"};
    const Param p = d.param("p", 10);
    auto b = d.add("hub", hub());
    auto wheel = d.add("wheel", RigidBody{.mass = 2, .PA = kPA});
    b.parent.force = -d.input("U", 6);
    bushing(d, "iso", wheel, b.child("C"), Rotation::about({0, 0, 1}, 0.5), make(p));
    d.output("y", 6) = b.parent.accel;
    return compile(d);
  };
  check_one(isolated([](const Param& p) {
              return Bushing{.stiffness = {4, 5, p, 7, 8, 9}, .damping = {1, 1, 1, 1, 1, 1}};
            }),
            percent(50), 1);
  check_one(isolated([](const Param& p) {
              return Bushing{.stiffness = {4, 5, 6, 7, 8, 9}, .damping = {1, 1, 1, 0.1 * p, 1, 1}};
            }),
            percent(50), 1);
  // Entries of a full matrix: one on the diagonal, a pair off it, all of a matrix of rank 6.
  Matrix6 K = Vector6(4, 5, 6, 7, 8, 9).asDiagonal();
  K(0, 4) = K(4, 0) = 0.5;
  check_one(isolated([&](const Param& p) {
              return Bushing{.stiffness = SixAxes(K).with(2, 2, 0.5 * p)};
            }),
            percent(50), 1);
  check_one(isolated([&](const Param& p) {
              return Bushing{.stiffness = SixAxes(K).with(5, 1, 0.05 * p), .damping = K};
            }),
            percent(50), 2);
  check_one(isolated([](const Param& p) {
              return Bushing{.stiffness = {p, 2 * p, 3 * p, p, p, 4 * p}};
            }),
            percent(50), 6);
}

TEST_CASE("frequencies and damping ratios") {
  check_one(with_boom(
                [](const Param& p) {
                  return ModeValues{.omega = {{2, p}}};
                },
                5),
            percent(30), 2);
  check_one(with_boom(
                [](const Param& p) {
                  return ModeValues{.xi = {{2, p}}};
                },
                0.02),
            percent(90), 1);
  check_one(with_boom(
                [](const Param& p) {
                  return ModeValues{.omega = {{1, 2 * p}, {2, 5 * p}, {3, 9 * p}}};
                },
                1),
            percent(30), 6);
  check_one(with_boom(
                [](const Param& p) {
                  return ModeValues{.xi = {{1, p}, {2, p}, {3, p}}};
                },
                0.02),
            percent(90), 3);
}

TEST_CASE("the tilt of a body") {
  const auto tilted = [](const RigidBody& tip, const Vector3d& axis, double times) {
    Diagram d{"tilt"};
    const Param p = d.param("p", 0.3);
    return two_bodies(hub(), tip, std::move(d),
                      Rotation::about({0, 0, 1}, 0.5) * Rotation::about(axis, times * p));
  };
  const RigidBody skew{
      .mass = 2,
      .inertia = (Matrix3d() << 3, 0.5, 0.25, 0.5, 4, -0.5, 0.25, -0.5, 5).finished(),
      .PA = kPA};
  const auto most = between(0.3 - 2.9, 0.3 + 2.5);
  check_one(tilted(skew, {1, 0, 0}, 1), most, 8);
  check_one(tilted(skew, {1, 2, -1}, -1), most, 8);
  check_one(tilted(skew, {0, 1, 0}, 2), most, 16);
  check_one(tilted(skew, {1, 0, 0}, 1), full_turn(), 16);
  const RigidBody on_axis{
      .mass = 2, .inertia = Vector3d(3, 4, 5).asDiagonal(), .PA = Vector3d(0.5, 0, 0)};
  check_one(tilted(on_axis, {1, 0, 0}, 1), most, 4);
}

TEST_CASE("a boom of circular section turned about its own axis: occurrences of the angle") {
  ModalData data;
  data.omega = Eigen::Vector2d(2, 2);
  data.xi = Eigen::Vector2d(0.01, 0.01);
  data.L_P = MatrixXd::Zero(2, 6);
  data.L_P << 0, 1.5, 0, 0, 0, 2, 0, 0, 1.5, 0, -2, 0;
  data.D_P = rigid_mass(6, Vector3d(0.5, 8, 8).asDiagonal(), Vector3d(-1, 0, 0));
  Diagram d{"round"};
  const Param p = d.param("p", 0.3);
  auto b = d.add("hub", hub());
  auto boom_ = d.add("boom", FlexibleBody{data});
  b.parent.force = -d.input("U", 6);
  mount(boom_, b.child, Rotation::about({1, 0, 0}, p));
  d.output("y", 6) = b.parent.accel;
  const System system = compile(d);
  check_one(system, between(-1, 2), 4, 0);
  const std::string text = to_string(lft(system, {{"p", between(-1, 2)}}));
  CHECK(text.find("at least 0") != std::string::npos);
  CHECK(text.find(" minimal") == std::string::npos);
}

TEST_CASE("a turned reading, a gain, and a rate beyond a tilt") {
  Diagram d{"readings"};
  const Param p = d.param("p", 0.3);
  auto b = d.add("hub", hub());
  b.parent.force = -d.input("U", 6);
  SUBCASE("one side only") {
    d.output("y", 6) = Rotation::about({1, 0, 0}, p) * b.parent.accel;
    check_one(compile(d), between(-2, 2), 4);
  }
  SUBCASE("gain") {
    auto gain = d.add("gain", Gain{.gain = -3 * p});
    gain.in = b.parent.accel.along({1, 0, 0});
    d.output("y") = gain.out;
    check_one(compile(d), between(-2, 2), 1);
  }
  SUBCASE("feedback of a rate") {
    b.parent.force += MatrixXd(Vector6::Unit(3)) * (p * b.parent.rate.angular().along({1, 0, 0}));
    d.output("y", 6) = b.parent.accel;
    check_one(compile(d), between(-2, 2), 1);
  }
  SUBCASE("rate and position in a tilted frame") {
    auto tip =
        d.add("tip", RigidBody{.mass = 2, .inertia = Vector3d(3, 4, 5).asDiagonal(), .PA = kPA});
    mount(tip, b.child, Rotation::about({1, 0, 0}, p));
    d.output("rate", 6) = tip.parent.rate;
    d.output("angle", 3) = tip.parent.position.angular();
    // Accelerations 4, wrenches 4, rate 4, angles 2: rotating commutes with integration for a
    // constant tilt only, which the lower bound counts on.
    check_one(compile(d), between(-2, 2), 14, 8);
  }
}

TEST_CASE("a law in the loop that reads rate and attitude beyond two tilts") {
  Diagram d{"law"};
  const Param p = d.param("p", 0.3);
  auto b = d.add("hub", hub());
  auto arm = d.add("arm", RigidBody{.mass = 2, .PA = kPA, .children = {{"E", {0.5, 0.1, 0.2}}}});
  auto tip = d.add("tip", FlexibleBody{boom()});
  const Rotation to_hub = Rotation::about({1, 0, 0}, p),
                 to_arm = Rotation::about({0, 0, 1}, 0.5) * Rotation::about({0, 1, 0}, -1 * p);
  mount(arm, b.child, to_hub);
  mount(tip, arm.child, to_arm);
  b.parent.force = -d.input("U", 6);
  b.parent.force.angular +=
      to_hub * to_arm * (3.0 * tip.parent.position.angular() + 5.0 * tip.parent.rate.angular());
  d.output("y", 6) = b.parent.accel;
  d.output("angle", 3) = tip.parent.position.angular();
  const System system = compile(d);
  const Lft f = lft(system, {{"p", between(-2, 2.5)}});
  INFO(to_string(f));
  CHECK(f.deltas()[0].at_least <= f.deltas()[0].size);
  for (const double value : {-1.9, -0.7, 0.1, 1.4, 2.4}) {
    const std::complex<double> s{0.2, 1.7};
    const Eigen::MatrixXcd G = system.update({{"p", value}}).transfer(s, Precision::digits50);
    CHECK((f.at({{"p", value}}).transfer(s) - G).norm() <= 1e-12 * G.norm());
  }
}

TEST_CASE("two examples of MATLAB's documentation: 2, 3, 1 and 2 occurrences") {
  // [3 + delta + eta, delta / eta; 7 + rho, rho + delta eta]
  Diagram d{"matrix"};
  const Param delta = d.param("delta", 3), eta = d.param("eta", 2), rho = d.param("rho", 7);
  auto u = d.input("u"), v = d.input("v");
  auto a = d.add("a", Gain{.gain = delta});  // delta v
  a.in = v;
  auto q = d.add("q", Gain{});  // q = delta v + q - eta q
  q.in = a.out + q.out - eta * q.out;
  d.output("y1") = 3.0 * u + delta * u + eta * u + q.out;
  d.output("y2") = 7.0 * u + rho * u + rho * v + eta * a.out;
  const Lft f =
      lft(compile(d), {{"delta", percent(40)}, {"eta", percent(40)}, {"rho", percent(40)}});
  INFO(to_string(f));
  for (const auto& [i, size] : {std::pair(0u, 2), {1u, 3}, {2u, 1}}) {
    CHECK(f.deltas()[i].size == size);
    CHECK(f.deltas()[i].minimal());
  }
  const StateSpace at = f.at({{"delta", 2.5}, {"eta", 2.25}, {"rho", 8.0}});
  const Eigen::Matrix2d want{{3 + 2.5 + 2.25, 2.5 / 2.25}, {7.0 + 8.0, 8.0 + 2.5 * 2.25}};
  CHECK((at.D - want).norm() <= 1e-14 * want.norm());

  // [a (a + 4), 6 a^2], written out term by term
  Diagram e{"row"};
  const Param p = e.param("p", 3);
  auto x = e.input("x"), y = e.input("y");
  e.output("y") = p * (p * x) + 4.0 * (p * x) + 6.0 * (p * (p * y));
  const System row = compile(e);
  check_one(row, percent(50), 2);
  CHECK(lft(row, {{"p", percent(50)}}).deltas()[0].built == 5);
}

TEST_CASE("the map of a range in percent is linear, though its ends are rounded") {
  using Kind = ParameterMap::Kind;
  const ParameterMap even(Kind::number, 3, 3 * 0.9, 3 * 1.1), uneven(Kind::number, 3, 2.7, 3.4);
  CHECK(even.shape != 0);
  CHECK(to_string(even, "m") == "(m - 3) / 0.3");
  CHECK(to_string(uneven, "m").starts_with("Moebius"));
}
