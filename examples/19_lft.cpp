// Parameters taken out of a model: a satellite with two wings whose hub mass, tilt of the wings,
// first frequency and damping are not fixed yet. One compile gives a linear fractional
// transformation with the least number of occurrences of each; ten thousand designs are then closed
// without compiling again, and exact derivatives give the effect of each parameter. Every model
// agrees with assembly by hand at the same values.
#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>
#include <random>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using std::numbers::pi;

namespace {

constexpr double kMass = 1000, kTilt = 0.4, kOmega = 1.57, kXi = 0.005;
const Vector3d kInertia(400, 500, 600);                 // of the hub [kg m^2]
const Vector3d kSites[] = {{0, 1, 0.2}, {0, -1, 0.2}};  // of the wings [m]
const double kYaw[] = {pi / 2, -pi / 2};

ModalData wing() {
  ModalData data;
  data.omega = Vector3d(kOmega, 3.77, 6.91);  // [rad/s]
  data.xi = Vector3d::Constant(kXi);
  data.L_P.resize(3, 6);
  data.L_P << 0, 0, 6.5, 0, -21, 0, 0, 5.8, 0, 0, 0, 19, 0, 0, 0, 3.9, 0, 0.5;
  data.D_P = rigid_mass(60, Vector3d(20, 180, 200).asDiagonal(), Vector3d(-2.5, 0, 0));
  return data;
}

Diagram satellite() {
  Diagram d{"satellite"};
  const Param m = d.param("m", kMass), tilt = d.param("tilt", kTilt);  // [kg], [rad]
  const Param w1 = d.param("w1", kOmega), xi = d.param("xi", kXi);     // [rad/s], [-]
  auto U = d.input("U", 3);                                            // torque on the hub [N m]
  auto hub = d.add("hub", RigidBody{.mass = m,
                                    .inertia = kInertia.asDiagonal(),
                                    .children = {{"L", kSites[0]}, {"R", kSites[1]}}});
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -U;
  const FlexibleBody panel{FlexibleBody{wing()}, {.omega = {{1, w1}}, .xi = {{1, xi}}}};
  auto left = d.add("left", panel), right = d.add("right", panel);
  const Rotation tilted = Rotation::about({1, 0, 0}, tilt);
  mount(left, hub.child("L"), Rotation::about({0, 0, 1}, kYaw[0]) * tilted);
  mount(right, hub.child("R"), Rotation::about({0, 0, 1}, kYaw[1]) * tilted);
  d.output("turn", 3) = hub.parent.accel.angular;  // [rad/s^2]
  return d;
}

struct Design {
  double m, tilt, w1, xi;
  ParameterList list() const { return {{"m", m}, {"tilt", tilt}, {"w1", w1}, {"xi", xi}}; }
};

/// Six motions of the hub, then three modes of each wing.
by_hand::Structure assembled(const Design& p) {
  by_hand::Structure a = by_hand::empty(12, 3, 3);
  a.M.topLeftCorner<6, 6>() = rigid_mass(p.m, kInertia.asDiagonal(), Vector3d::Zero());
  a.M.bottomRightCorner<6, 6>().setIdentity();
  ModalData data = wing();
  data.omega(0) = p.w1, data.xi(0) = p.xi;
  for (int i = 0; i < 2; ++i) {
    const Matrix3d turn = (Eigen::AngleAxisd(kYaw[i], Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(p.tilt, Vector3d::UnitX()))
                              .toRotationMatrix();
    // Motion of the hub to that of the wing's root, in the axes of the wing.
    const Matrix6 to_wing = by_hand::dual(turn.transpose()) * by_hand::tau(-kSites[i]);
    const int eta = 6 + 3 * i;
    a.M.topLeftCorner<6, 6>() += to_wing.transpose() * data.D_P * to_wing;
    a.M.block<3, 6>(eta, 0) = data.L_P * to_wing;
    a.M.block<6, 3>(0, eta) = a.M.block<3, 6>(eta, 0).transpose();
    a.K.diagonal().segment<3>(eta) = data.omega.cwiseAbs2();
    a.D.diagonal().segment<3>(eta) = 2 * data.xi.cwiseProduct(data.omega);
  }
  a.B.middleRows<3>(3).setIdentity();
  a.C.middleCols<3>(3).setIdentity();
  return a;
}

/// A random design in the ranges.
Design drawn(const Lft& f, std::mt19937& random) {
  const auto value = [&](std::size_t i) {
    return f.deltas()[i].map.value(2 * (static_cast<double>(random()) / 4294967296.0) - 1);
  };
  const double m = value(0), tilt = value(1), w1 = value(2), xi = value(3);
  return {m, tilt, w1, xi};
}

}  // namespace

int main() {
  const System system = compile(satellite());
  const Lft f = lft(system, {{"m", percent(20)},
                             {"tilt", between(-1.2, 1.9)},
                             {"w1", percent(30)},
                             {"xi", between(0.001, 0.02)}});
  std::printf("%s", to_string(f).c_str());
  write_matlab(f, "satellite.m");  // a uss of ureal
  write_numpy(f, ".", "satellite");

  // The slowest mode of all designs.
  std::mt19937 random(1);
  double least = 1e9, worst = 0;
  Design slowest{};
  for (int i = 0; i < 10000; ++i) {
    const Design p = drawn(f, random);
    const StateSpace at = f.at(p.list());
    if (i % 100 == 0) {
      const double omega = poles(at).front().omega;
      if (omega < least) least = omega, slowest = p;
      const by_hand::Complex s{0.1, 2.0 + 0.05 * i / 100};
      worst = std::max(worst, by_hand::transfer_error({at.transfer(s)},
                                                      {by_hand::accel_transfer(assembled(p), s)}));
    }
  }
  std::printf(
      "\n10000 designs closed; slowest mode of every 100th: %.3f rad/s at %.0f kg, %.2f rad\n",
      least, slowest.m, slowest.tilt);

  // Which way each parameter moves the modes.
  const Derivatives g = derivatives(system, {"m", "tilt", "w1", "xi"});
  std::printf("\n%12s %12s %12s %12s   [rad/s per unit]\n", "mode [rad/s]", "by m", "by tilt",
              "by w1");
  for (const PoleSlopes& p : g.poles())
    std::printf("%12.5f %12.4g %12.4g %12.4g\n", p.s.imag(), p.slopes[0](0).imag(),
                p.slopes[1](0).imag(), p.slopes[2](0).imag());
  const by_hand::Complex s{0.05, 1.6};
  const double h = 1e-4;
  const by_hand::MatrixXcd difference =
      (by_hand::accel_transfer(assembled({kMass, kTilt + h, kOmega, kXi}), s) -
       by_hand::accel_transfer(assembled({kMass, kTilt - h, kOmega, kXi}), s)) /
      (2 * h);
  const double off = by_hand::transfer_error({g.transfer(s, "tilt")}, {difference}, 3, 3);

  bool minimal = true;
  for (const Delta& d : f.deltas()) minimal &= d.minimal();
  std::printf("\nleast numbers of occurrences: %s\n", minimal ? "proven" : "NO");
  const bool ok = by_hand::agrees("all designs against M, D, K", worst, 1e-11);
  return by_hand::agrees("derivative by the tilt against a difference", off, 1e-6) && ok && minimal
             ? 0
             : 1;
}
