// Rotors and momenta: closed forms of gyroscopes, published rotors, signs, and reversed momenta.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "lft/n17.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

using namespace titop;
using namespace titop_test;

namespace {

const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

/// Frequencies above 0, ascending [rad/s]; all are undamped.
std::vector<double> frequencies(const System& system) {
  std::vector<double> result;
  for (const Pole& p : system.poles()) {
    if (p.omega > 0) result.push_back(p.omega);
    CHECK(std::abs(p.damping) <= 1e-9);
  }
  return result;
}

void check_frequencies(const System& system, const std::vector<double>& expected, double within) {
  const std::vector<double> found = frequencies(system);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(found[i] - expected[i]) <= within * expected[i]);
  }
}

/// Reciprocal if the momenta are reversed, passive, and without fault.
void check_gyroscopic(const System& system) {
  const FullCertificate c = certify(system);
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(c.passivity.structure);
  CHECK(c.passivity.least >= -1e-10);
  CHECK(c.reciprocity.structure);
  CHECK(c.reciprocity.reversed);
  CHECK(c.reciprocity.asymmetry <= 1e-10);
}

RigidBody hub_of(const Vector3d& inertia) {
  return {.mass = 1000, .inertia = inertia.asDiagonal(), .children = {{"B", {0.3, -0.2, 0.5}}}};
}

/// Torques on a free hub of 400, 500 and 600 kg m^2, to its rates; `h` about y.
template <class Add>
System free_hub(Add add) {
  Diagram d{"hub"};
  auto hub = d.add("hub", hub_of({400, 500, 600}));
  hub.parent.force = -d.input("U", 6);
  add(d, hub);
  d.output("rate", 3) = hub.parent.rate.angular();
  d.output("accel", 6) = hub.parent.accel;
  return compile(d);
}

}  // namespace

TEST_CASE("momentum: nutation h / sqrt(I_x I_z), and the sign of precession, at any port") {
  const double h = 50;
  const std::vector<System> systems = {
      free_hub([&](Diagram&, auto& hub) { momentum(hub.parent, h, y); }),
      free_hub([&](Diagram&, auto& hub) { momentum(hub.child("B"), h, y); }),
      free_hub([&](Diagram&, auto& hub) { momentum(hub.child("B"), -h, -3 * y); })};
  for (const System& s : systems) {
    check_frequencies(s, {h / std::sqrt(400.0 * 600.0)}, 1e-12);
    check_gyroscopic(s);
    for (const Pole& pole : s.poles()) {
      REQUIRE(pole.blocks.size() >= 1);
      CHECK(pole.blocks[0].first.starts_with("hub.parent.angular"));
    }
    // Of a constant torque the momentum follows: h omega_z = -T_x, h omega_x = T_z.
    const Eigen::MatrixXcd slow = s.transfer({0, 1e-7});
    CHECK(std::abs(slow(2, 3) + 1 / h) <= 1e-9);
    CHECK(std::abs(slow(0, 5) - 1 / h) <= 1e-9);
  }
}

TEST_CASE("a rotor held at its speed is a rigid body with momentum") {
  const Rotor rotor{
      .mass = 6, .axial = 0.05, .transverse = 0.03, .axis = {1, 2, 2}, .PA = {0.1, 0, -0.2}};
  const Vector3d a = rotor.axis / 3;
  const Matrix3d I = 0.03 * Matrix3d::Identity() + 0.02 * a * a.transpose();
  const Rotation tilt = Rotation::about({1, 1, 0}, 0.7);
  const double h = 7;
  const System as_rotor = free_hub([&](Diagram& d, auto& hub) {
    Rotor spinning = rotor;
    spinning.momentum = h;
    auto wheel = d.add("wheel", spinning);
    mount(wheel, hub.child("B"), tilt);
    wheel.accel = 0;
  });
  const System as_body = free_hub([&](Diagram& d, auto& hub) {
    auto wheel = d.add("wheel", RigidBody{.mass = 6, .inertia = I, .PA = rotor.PA});
    mount(wheel, hub.child("B"), tilt);
    momentum(wheel.parent, h, rotor.axis);
  });
  for (const std::complex<double> s : {std::complex<double>(0.1, 0.3), {0, 2}}) {
    const Eigen::MatrixXcd right = as_body.transfer(s);
    CHECK((as_rotor.transfer(s) - right).norm() <= 1e-13 * right.norm());
  }
}

TEST_CASE("a control moment gyroscope: sqrt((I_x k + h^2) / (I_x J_g)), and its torque's sign") {
  const double h = 50, k = 200, J = 0.5;
  const auto cmg = [&](bool driven) {
    Diagram d{"cmg"};
    auto hub = d.add("hub", hub_of({400 - J, 500, 600}));
    auto rotor =
        d.add("rotor", Rotor{.mass = 0, .axial = 0.6, .transverse = J, .axis = y, .momentum = h});
    hub.parent.accel.linear = 0;
    hub.parent.accel.angular.along(y) = 0;
    hub.parent.accel.angular.along(z) = 0;
    hub.parent.force.angular.along(x) = -d.input("T");
    auto gimbal = hinge(d, "gimbal", rotor, hub.child("B"), {}, z);
    if (driven)
      gimbal.accel = d.input("u");
    else
      gimbal.torque = k * gimbal.angle - d.input("u");
    rotor.accel = 0;
    d.output("rate") = hub.parent.rate.angular().along(x);
    d.output("gimbal") = gimbal.rate;
    return compile(d);
  };
  const System sprung = cmg(false);
  check_frequencies(sprung, {std::sqrt((400 * k + h * h) / (400 * J))}, 1e-12);
  CHECK(certify(sprung).holds());
  // At the gimbal's rate the torque on the hub about x is +h rate: 400 s omega_x = h rate.
  const std::complex<double> at(0.2, 1);
  const Eigen::MatrixXcd H = cmg(true).transfer(at);
  CHECK(std::abs(H(0, 1) * 400.0 * at - h * H(1, 1)) <= 1e-12 * std::abs(h * H(1, 1)));
}

TEST_CASE("rocking of a disk on springs: two whirls, 75 and 600 rad/s") {
  Diagram d{"disk"};
  auto base = d.add("base", RigidBody{.children = {{"c"}}});
  ground(base);
  auto disk =
      d.add("disk", Rotor{.mass = 3, .axial = 0.035, .transverse = 0.02, .momentum = 0.035 * 300});
  auto u = joint(d, "u", disk, base.child("c"), Rotation::about({2, 1, 0}, 0.3), universal(x, y));
  disk.torque = 0;
  auto a = u.axis("axis1"), b = u.axis("axis2");
  a.force = 900.0 * a.position - d.input("t");
  b.force = 900.0 * b.position;
  d.output("tilt") = a.position;
  const System s = compile(d);
  check_frequencies(s, {75, 600}, 1e-12);
  CHECK(certify(s).holds());
}

TEST_CASE("two disks on a shaft [Friswell 2010, ex. 5.9.1]: whirls at rest and at 4,000 rpm") {
  // By beam elements and disks of another program, 6 and 48 elements, without the shaft's own
  // gyroscopic terms; the published values, of Timoshenko elements with them, are within 0.4 %.
  const auto shaft = [](int elements, double rpm) {
    const double speed = rpm * 2 * std::numbers::pi / 60, r = 0.025;
    const double I = std::numbers::pi * std::pow(r, 4) / 4, A = std::numbers::pi * r * r;
    Diagram d{"shaft"};
    auto base = d.add("base", RigidBody{.children = {{"left"}}});
    ground(base);
    const Beam third{.length = 0.5,
                     .section = {A, I, I, 2 * I},
                     .material = {.E = 211e9, .G = 81.2e9, .rho = 7810},
                     .elements = elements,
                     .modes = {.kept = 12, .residual = {"P", "C"}}};
    auto s1 = d.add("s1", FlexibleBody{third}), s2 = d.add("s2", FlexibleBody{third}),
         s3 = d.add("s3", FlexibleBody{third});
    bushing(d, "bearing", s1, base.child("left"), {}, {.stiffness = {1e9, 1e6, 1e6, 1e6, 0, 0}});
    mount(s2, s1.child), mount(s3, s2.child);
    const auto disk = [&](const char* name, double mass, double axial, double transverse,
                          auto& end) {
      auto rotor = d.add(name, Rotor{.mass = mass,
                                     .axial = axial,
                                     .transverse = transverse,
                                     .axis = x,
                                     .momentum = axial * speed});
      rotor.accel = 0;
      mount(rotor, end.child);
    };
    disk("d1", 32.589728, 0.329563621, 0.178089283, s1);
    disk("d2", 51.525261, 0.805082205, 0.423580584, s2);
    for (const Vector3d& across : {y, z})
      s3.child.force.linear.along(across) += -1e6 * s3.child.position.linear().along(across);
    s3.child.force += d.input("F", 6);
    d.output("a", 6) = s3.child.accel;
    return compile(d);
  };
  const auto check_bending = [](const System& s, const std::vector<double>& expected,
                                double within) {
    std::vector<double> found = frequencies(s);
    std::erase_if(found, [](double w) {  // the shaft's torsion modes, by linear elements
      return std::abs(w - 228.5355) <= 1e-2 || std::abs(w - 803.587) <= 1e-2;
    });
    REQUIRE(found.size() >= expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CAPTURE(i);
      CHECK(std::abs(found[i] - expected[i]) <= within * expected[i]);
    }
  };
  check_bending(shaft(2, 0), {86.71578, 86.71578, 274.77623, 274.77623, 717.63648, 717.63648},
                1e-7);
  check_bending(shaft(2, 4000), {85.46030, 87.84090, 252.21505, 295.23701, 601.24866, 827.70282},
                1e-7);
  const System rest = shaft(16, 0), spinning = shaft(16, 4000);
  check_bending(rest, {86.71571, 86.71571, 274.77221, 274.77221, 717.48165, 717.48165}, 1e-6);
  check_bending(spinning, {85.46024, 87.84083, 252.21220, 295.23174, 601.18037, 827.41241}, 1e-6);
  check_bending(rest, {86.66, 86.66, 274.31, 274.31, 716.78, 716.78}, 4e-3);
  check_bending(spinning, {85.39, 87.80, 251.78, 294.71, 600.18}, 4e-3);
}

TEST_CASE("a satellite with two wings and bias momentum") {
  const auto satellite = [](double tilt, double h, const Vector3d& axis) {
    ModalData wing = lft_test::wing_data(false, 1);
    wing.omega = 2 * std::numbers::pi * Vector3d(0.25, 0.6, 1.1);
    wing.xi.setZero();
    Diagram d{"satellite"};
    auto hub = d.add("hub", RigidBody{.mass = 1000,
                                      .inertia = Vector3d(400, 500, 600).asDiagonal(),
                                      .children = {{"L", {0, 1, 0.2}}, {"R", {0, -1, 0.2}}}});
    for (const double side : {1.0, -1.0}) {
      auto w = d.add(side > 0 ? "left" : "right", FlexibleBody{wing});
      mount(w, hub.child(side > 0 ? "L" : "R"),
            Rotation::about(z, side * std::numbers::pi / 2) * Rotation::about(x, tilt));
    }
    momentum(hub.parent, h, axis);
    hub.parent.force += d.input("U", 6) * -1.0;
    d.output("a", 6) = hub.parent.accel;
    return compile(d);
  };
  // By another program, assembled by M, G and K; seven decimals.
  const auto check_decimals = [](const System& system, const std::vector<double>& expected) {
    const std::vector<double> found = frequencies(system);
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CAPTURE(i);
      CHECK(std::abs(found[i] - expected[i]) <= 5.1e-8);
    }
  };
  check_decimals(satellite(0, 50, y),
                 {0.0212825, 1.6336305, 2.7637718, 3.8964852, 5.3202581, 6.9139070, 7.1144044});
  check_decimals(satellite(0, 500, y),
                 {0.2113575, 1.6336305, 2.7744935, 3.8964852, 5.3364624, 6.9139343, 7.1144044});
  const System fast = satellite(std::numbers::pi / 6, 500, {1, 1, 1});
  check_decimals(fast,
                 {0.3768260, 1.7579377, 2.2359684, 4.6242256, 5.1189866, 6.9132442, 7.1168624});
  check_gyroscopic(fast);
}

TEST_CASE("wheels anywhere in trees: passive, and reciprocal with momenta reversed") {
  Rng random(20261129);
  const auto vector = [&] {
    return Vector3d(random.between(-1, 1), random.between(-1, 1), random.between(0.2, 1));
  };
  for (int i = 0; i < 12; ++i) {
    CAPTURE(i);
    Diagram d{"wheels"};
    auto hub = d.add("hub", RigidBody{.mass = 50,
                                      .inertia = Vector3d(9, 8, 7).asDiagonal(),
                                      .PA = 0.1 * vector(),
                                      .children = {{"A", vector()}, {"B", vector()}}});
    auto boom = d.add("boom", FlexibleBody{Beam{.length = 2,
                                                .section = rectangle(0.06, 0.04),
                                                .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                                .elements = 1,
                                                .modes = {.kept = 4, .xi = {0.01}}}});
    auto tip = d.add(
        "tip",
        RigidBody{.mass = 3, .inertia = Matrix3d::Identity() / 8, .children = {{"C", vector()}}});
    const Rotation turn = Rotation::about(vector(), random.between(0, 3));
    auto h = hinge(d, "h", boom, hub.child("A"), turn, vector());
    h.torque = 40.0 * h.angle + 0.5 * h.rate;
    mount(tip, boom.child, Rotation::about(vector(), 0.4));
    if (i % 2)  // one axis of the tip on a spring to the ground
      tip.child("C").force.linear.along(y) += -300.0 * tip.child("C").position.linear().along(y);
    for (const bool on_hub : {true, false}) {
      auto wheel = d.add(on_hub ? "w1" : "w2", Rotor{.mass = 2,
                                                     .axial = 0.02,
                                                     .transverse = 0.015,
                                                     .axis = vector(),
                                                     .momentum = random.between(-30, 30),
                                                     .PA = 0.1 * vector()});
      mount(wheel, on_hub ? hub.child("B") : tip.child("C"), Rotation::about(vector(), 1));
      wheel.torque = random.between(0, 1) * wheel.speed;
    }
    hub.parent.force = -d.input("U", 6);
    tip.child("C").force += d.input("F", 6);
    d.output("of U", 6) = hub.parent.accel;
    d.output("of F", 6) = tip.child("C").accel;
    const System system = compile(d);
    check_gyroscopic(system);
    CHECK(count_notes(system, Note::Kind::warning, "check") == 0);  // no rounding is a damper
  }
}
