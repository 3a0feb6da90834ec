// A solar array drive: a stepper motor on the hub turns three hinged panels through a gear. The
// motor's angle is N times that of the array, and its detent is a spring to the commanded angle:
// the array meets the stiffness k_d N^2 and the inertia J_m N^2. A turn of the hub turns the motor
// too: J_m N couples them. The equations of the hinge's torque and of the hub say so, with
// accelerations in them: the compiler solves that loop. Micro-steps of the command have an error
// that repeats with every step: its harmonics, and the pointing error of the hub at each of them,
// over the tilt of the array. The same by hand, from M, D and K, also at another N and J_m.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/solar_array_drive.hpp"

using namespace titop;
using namespace scenes::solar_array_drive;

namespace {

/// Coordinates: hub 0 to 5, drive 6, hinges 7 and 8.
by_hand::Structure satellite_by_hand(const ArrayDrive& design) {
  constexpr by_hand::Index n = 9, drive = 6;
  const double N = design.gear;
  by_hand::Structure a = by_hand::empty(n, 1, 3);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(hub_mass);
  a.M.block(3, 3, 3, 3) = hub_inertia.asDiagonal();
  by_hand::MatrixXd spin = by_hand::MatrixXd::Zero(1, n);  // of the motor
  spin(4) = 1, spin(drive) = N;
  a.M += design.motor_inertia * spin.transpose() * spin;
  const Eigen::Matrix3d T = Eigen::AngleAxisd(design.tilt, Vector3d::UnitY()).toRotationMatrix();
  by_hand::MatrixXd root = by_hand::MatrixXd::Zero(6, n);  // motion of a panel's root, its frame
  root.leftCols(6) = by_hand::dual(T.transpose()) * by_hand::tau(-array_at);
  for (int i = 0; i < kPanels; ++i) {
    root(i == 0 ? 4 : 3, drive + i) += 1;  // about y, about x
    by_hand::Matrix6 mass = by_hand::Matrix6::Zero();
    mass.diagonal() << Vector3d::Constant(panel_mass), panel_inertia();
    const by_hand::MatrixXd centre = by_hand::tau(-panel_centre) * root;
    a.M += centre.transpose() * mass * centre;
    root = by_hand::tau(Vector3d(0, -panel_width, 0)) * root;
    if (i == 0) continue;
    a.K(drive + i, drive + i) = panel_k;
    a.D(drive + i, drive + i) = panel_c;
  }
  a.D(drive, drive) += N * N * detent_c;
  a.K(drive, drive) += N * N * detent_k;
  a.B(drive, 0) = N * detent_k;
  a.C.block(0, 3, 3, 3).setIdentity();
  return a;
}

double error_by_hand(const System& system, const ArrayDrive& design) {
  std::vector<by_hand::MatrixXcd> ours, right;
  for (const by_hand::Complex s : by_hand::ray(0.01, 100, 12)) {
    ours.push_back(system.transfer(s));
    right.push_back(by_hand::accel_transfer(satellite_by_hand(design), s));
  }
  return by_hand::transfer_error(ours, right);
}

/// Largest turn of the hub due to harmonic n of a sawtooth of one step, step / (pi n) sin(n w t).
double pointing(const System& system, double omega, int n) {
  const std::complex<double> s{0, n * omega};
  return (system.transfer(s) / (s * s)).norm() * step / (std::numbers::pi * n);
}

}  // namespace

int main() {
  const System flat = compile(satellite());
  std::printf("order %d, with the tilt, N and J_m as parameters\n", flat.state_space().order());
  std::printf("turn of the hub [urad] at harmonics of 1.6 steps per second\n%10s", "tilt [rad]");
  for (int n = 1; n <= 4; ++n) std::printf(" %9d", n);
  double off = 0;
  for (const double tilt : {0.0, 0.6, 1.2}) {
    const ArrayDrive design{.tilt = tilt};
    const System system = flat.update(design.list());
    std::printf("\n%10.1f", tilt);
    for (int n = 1; n <= 4; ++n)
      std::printf(" %9.4g", 1e6 * pointing(system, 2 * std::numbers::pi * 1.6, n));
    off = std::max(off, error_by_hand(system, design));
  }
  const ArrayDrive other{.tilt = 0.6, .gear = 80, .motor_inertia = 3e-5};
  off = std::max(off, error_by_hand(flat.update(other.list()), other));
  std::printf("\n");
  return by_hand::agrees("transfers, also at another N and J_m", off, 1e-9) ? 0 : 1;
}
