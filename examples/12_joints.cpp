// Joints and springs between bodies: a reaction wheel on an isolator of six axes, a mast on a
// jack, a dish on a gimbal whose elevation a closed triangle of links gives, a tuned mass damper
// along one axis of the mast's tip.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;
using std::numbers::pi;

namespace {

const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

constexpr double hub_mass = 120, wheel_mass = 6, dish_mass = 8;  // [kg]
const Vector3d hub_inertia(20, 25, 18), wheel_inertia(0.03, 0.03, 0.05), dish_inertia(1, 1, 1.6);
const Vector3d wheel_at(0.2, -0.3, 0.1), mast_at(0.6, 0, 0), dish_at(-0.5, 0.1, 0.3);  // from P
const Vector3d dish_PA(0, 0, 0.25);  // from the gimbal to the dish's centre of mass [m]

const Vector6 iso_k = (Vector6() << 3e4, 3e4, 6e4, 220, 220, 150).finished();  // [N/m; N m/rad]
const Vector6 iso_c = (Vector6() << 25, 25, 40, 0.2, 0.2, 0.1).finished();
const Vector3d wheel_tilt_axis(1, 1, 0);
constexpr double wheel_tilt = 0.6;                         // the wheel's spin axis is skewed [rad]
constexpr double jack_k = 8e4, jack_c = 60;                // [N/m], [N s/m]
constexpr double gimbal_k[] = {900, 1400};                 // [N m/rad]
constexpr double gimbal_c = 0.8;                           // [N m s/rad]
constexpr double tmd_mass = 0.2, tmd_k = 60, tmd_c = 0.9;  // [kg], [N/m], [N s/m]
constexpr double mast_length = 1.6;                        // [m]

// The dish's frame is turned about y by a strut: triangle of base, arm and strut, in its plane.
constexpr double base = 0.40, arm = 0.30, strut = 0.35;  // [m]

/// Elevation at which the strut closes the triangle.
Posture dish_posture() {
  return posture({{.joint = about(y, "elevation"), .guess = 1, .link = {arm, 0, 0}},
                  {.joint = about(y, "strut top"), .guess = 2},
                  {.joint = along(x, "strut"), .given = strut},
                  {.joint = about(y, "strut foot"), .guess = 2, .link = {-base, 0, 0}}});
}

enum class Mounting { isolated, rigid };

Diagram satellite(Mounting kind) {
  Diagram d{"satellite"};
  auto w = d.input("w", 6);  // of the wheel on its own frame: imbalance and bearing noise
  auto u = d.input("u");     // force of the jack on the mast
  auto hub = d.add("hub", RigidBody{.mass = hub_mass,
                                    .inertia = hub_inertia.asDiagonal(),
                                    .children = {{"W", wheel_at}, {"M", mast_at}, {"D", dish_at}}});
  auto wheel = d.add("wheel", RigidBody{.mass = wheel_mass,
                                        .inertia = wheel_inertia.asDiagonal(),
                                        .children = {{"rotor"}}});
  auto mast = d.add("mast", FlexibleBody{Beam{.length = mast_length,
                                              .section = tube(0.05, 0.045),
                                              .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                                              .elements = 2}});
  auto dish = d.add(
      "dish", RigidBody{.mass = dish_mass, .inertia = dish_inertia.asDiagonal(), .PA = dish_PA});
  auto damper = d.add("damper", SpringMass{.mass = tmd_mass, .stiffness = tmd_k, .damping = tmd_c});
  release(hub);

  const Rotation tilt = Rotation::about(wheel_tilt_axis, wheel_tilt);
  wheel.child.force = w;
  if (kind == Mounting::isolated)
    bushing(d, "isolator", wheel, hub.child("W"), tilt, {.stiffness = iso_k, .damping = iso_c});
  else
    mount(wheel, hub.child("W"), tilt);

  auto jack = slide(d, "jack", mast, hub.child("M"), {}, x);
  jack.force = jack_k * jack.travel + jack_c * jack.rate - u;

  auto gimbal = joint(d, "gimbal", dish, hub.child("D"), dish_posture().T_ba[0],
                      {about(x, "roll"), about(y, "pitch")});
  auto roll = gimbal.axis("roll"), pitch = gimbal.axis("pitch");
  roll.force = gimbal_k[0] * roll.position + gimbal_c * roll.rate;
  pitch.force = gimbal_k[1] * pitch.position + gimbal_c * pitch.rate;

  mount(damper, mast.child.along(z));

  d.output("hub", 6) = hub.parent.accel;
  d.output("dish", 3) = dish.parent.accel.angular;
  d.output("travel") = jack.travel;
  return d;
}

// --- the same by hand ----------------------------------------------------------------------------

double elevation() {
  return std::acos((base * base + arm * arm - strut * strut) / (2 * base * arm));
}

/// A rigid body whose reference point moves by `motion` (6 x n), centre of mass at PA from it.
void add_rigid(by_hand::Structure& a, const by_hand::MatrixXd& motion, double mass,
               const Vector3d& inertia, const Vector3d& PA = Vector3d::Zero()) {
  const by_hand::MatrixXd centre = by_hand::tau(-PA) * motion;
  a.M += mass * centre.topRows(3).transpose() * centre.topRows(3);
  a.M += centre.bottomRows(3).transpose() * inertia.asDiagonal() * centre.bottomRows(3);
}

/// Motion of a point of the hub, in a frame turned against it.
by_hand::MatrixXd seen_at(const Vector3d& PC, const Eigen::Matrix3d& T_ba, by_hand::Index n) {
  by_hand::MatrixXd motion = by_hand::MatrixXd::Zero(6, n);
  motion.leftCols(6) = by_hand::dual(T_ba.transpose()) * by_hand::tau(-PC);
  return motion;
}

/// Coordinates: hub 0, isolator 6, jack 12, nodes of the mast 13, damper 25, gimbal 26 (28 in all).
by_hand::Structure by_hand_satellite() {
  constexpr by_hand::Index n = 28;
  by_hand::Structure a = by_hand::empty(n, 7, 10);
  const by_hand::MatrixXd hub = seen_at(Vector3d::Zero(), Eigen::Matrix3d::Identity(), n);
  add_rigid(a, hub, hub_mass, hub_inertia);

  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(wheel_tilt, wheel_tilt_axis.normalized()).toRotationMatrix();
  by_hand::MatrixXd wheel = seen_at(wheel_at, tilt, n);
  wheel.middleCols(6, 6).setIdentity();
  add_rigid(a, wheel, wheel_mass, wheel_inertia);
  a.K.block(6, 6, 6, 6) = iso_k.asDiagonal();
  a.D.block(6, 6, 6, 6) = iso_c.asDiagonal();

  const by_hand::Beam beam = by_hand::tube(mast_length, 0.05, 0.045, 70e9, 2700, 2);
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  by_hand::MatrixXd root = seen_at(mast_at, Eigen::Matrix3d::Identity(), n);
  root(0, 12) = 1;
  a.K(12, 12) = jack_k, a.D(12, 12) = jack_c;
  by_hand::MatrixXd mast = by_hand::rigid_motion(beam) * root;
  mast.block<12, 12>(6, 13) += by_hand::MatrixXd::Identity(12, 12);
  a.M += mast.transpose() * fe.M * mast;
  a.K.block<12, 12>(13, 13) += fe.K.bottomRightCorner<12, 12>();

  by_hand::MatrixXd damper = mast.row(6 * 2 + 2);  // tip, z
  damper(0, 25) += 1;
  a.M += tmd_mass * damper.transpose() * damper;
  a.K(25, 25) = tmd_k, a.D(25, 25) = tmd_c;

  by_hand::MatrixXd dish =
      seen_at(dish_at, Eigen::AngleAxisd(elevation(), y).toRotationMatrix(), n);
  dish(3, 26) = dish(4, 27) = 1;
  add_rigid(a, dish, dish_mass, dish_inertia, dish_PA);
  a.K(26, 26) = gimbal_k[0], a.K(27, 27) = gimbal_k[1];
  a.D(26, 26) = a.D(27, 27) = gimbal_c;

  a.C.topRows(6) = hub;
  a.C.middleRows(6, 3) = dish.bottomRows(3);
  a.C(9, 12) = 1;
  a.B.leftCols(6) = wheel.transpose();
  a.B(12, 6) = 1;
  return a;
}

/// The wheel welded to the hub: the same without the isolator's coordinates.
by_hand::Structure welded(const by_hand::Structure& a) {
  std::vector<by_hand::Index> keep;
  for (by_hand::Index i = 0; i < a.M.rows(); ++i)
    if (i < 6 || i >= 12) keep.push_back(i);
  return {a.M(keep, keep), a.D(keep, keep), a.K(keep, keep), a.B(keep, Eigen::all),
          a.C(Eigen::all, keep)};
}

bool check(Mounting kind, const by_hand::Structure& a) {
  const System system = compile(satellite(kind));
  const StateSpace& model = system.state_space();
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {3.0, 15.0, 40.0, 90.0, 300.0, 2000.0, 20000.0}) {
    const by_hand::Complex s{0.1 * w, w};
    scene.push_back(system.transfer(s));
    dense.push_back(model.transfer(s));
    hand.push_back(by_hand::accel_transfer(a, s));
    hand.back().bottomRows(1) /= s * s;
  }
  bool ok =
      by_hand::agrees("  transfer against M and K", by_hand::transfer_error(scene, hand), 1e-10);
  ok &=
      by_hand::agrees("  dense model against M and K", by_hand::transfer_error(dense, hand), 1e-8);
  ok &= by_hand::agrees(
      "  poles against M and K",
      by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(by_hand::elastic(a, 6))),
      1e-9);
  const auto least = 2 * (a.M.rows() - 6);
  std::printf("  order %d, coordinates beside the rigid motion: %ld\n", model.order(),
              static_cast<long>(a.M.rows() - 6));
  return ok && model.order() == least;
}

/// Largest angular acceleration of the dish per force of the wheel across its axis, at f [Hz].
double jitter(Mounting kind, double f) {
  const Eigen::MatrixXcd G = compile(satellite(kind)).transfer({0, 2 * pi * f});
  return G.block(6, 0, 3, 2).cwiseAbs().maxCoeff();
}

}  // namespace

int main() {
  const double found = dish_posture().values[0];
  bool ok = by_hand::agrees("elevation against the cosine rule",
                            std::abs(found - elevation()) / elevation(), 1e-13);
  std::printf("elevation %.4f deg\n", found * 180 / pi);
  try {
    posture({{.joint = about(y, "elevation"), .link = {arm, 0, 0}},
             {.joint = about(y)},
             {.joint = along(x, "strut"), .given = base + arm + 0.1},
             {.joint = about(y, "strut foot"), .link = {-base, 0, 0}}});
    ok = false;
  } catch (const Error& e) {
    std::printf("a strut of 0.8 m: %s\n", std::string(to_string(e.mistakes()[0].code)).c_str());
  }

  const by_hand::Structure a = by_hand_satellite();
  std::printf("wheel on its isolator:\n");
  ok &= check(Mounting::isolated, a);
  std::printf("wheel fixed to the hub:\n");
  ok &= check(Mounting::rigid, welded(a));
  std::printf("jitter of the dish, isolated over fixed:");
  for (const double f : {2.0, 10.0, 30.0, 100.0})
    std::printf("  %g Hz %.3g", f, jitter(Mounting::isolated, f) / jitter(Mounting::rigid, f));
  std::printf("\n");
  return ok ? 0 : 1;
}
