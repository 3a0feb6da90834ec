// Reaction wheels with momentum: a hub with a boom, turned by four wheels in a pyramid under an
// attitude law. Each wheel is a `Rotor`: its spin is a channel, and its momentum at constant speed
// acts on the hub by the gyroscopic torque h a x omega. With momenta the wheels stiffen the hub
// like a spinning top: a torque about one axis turns it about another. Torquers take the momentum
// out of the wheels. On a plate on springs the imbalance of a wheel turns the hub, and so a
// telescope's line of sight, at the wheel's speed; the plate's modes move with that speed
// (waterfall.svg). The same by hand, from M, D, K with the antisymmetric gyroscopic terms in D; the
// certificate checks the structure without the law with all momenta reversed. Reduced models keep
// the second-order form with these terms as a skew matrix G: stable and passive at any wheel speed.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/wheels.hpp"

using namespace titop;
using namespace scenes::wheels;
using std::numbers::pi;

namespace {

/// a x
Eigen::Matrix3d cross_matrix(const Vector3d& a) {
  Eigen::Matrix3d turn;
  turn << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return turn;
}

constexpr by_hand::Index first_wheel = 18, on_springs = 22;

/// Hub and boom: coordinates 0 to 5, and nodes of the boom 6 to 17.
void add_hub(by_hand::Structure& a) {
  a.M.topLeftCorner(3, 3).diagonal().setConstant(hub_mass);
  a.M.block(3, 3, 3, 3) = hub_inertia.asDiagonal();
  const by_hand::Beam beam = by_hand::tube(boom_length, 0.05, 0.046, 70e9, 2700, 2);
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  by_hand::MatrixXd root = by_hand::MatrixXd::Zero(6, a.M.rows());
  root.leftCols(6) = by_hand::tau(-boom_at);
  by_hand::MatrixXd nodes = by_hand::rigid_motion(beam) * root;
  nodes.block<12, 12>(6, 6) += by_hand::MatrixXd::Identity(12, 12);
  a.M += nodes.transpose() * fe.M * nodes;
  a.K.block<12, 12>(6, 6) += fe.K.bottomRightCorner<12, 12>();
}

/// Wheel i at a point whose motion is `site` (6 x n): its angle is coordinate 18 + i.
void add_wheel(by_hand::Structure& a, int i, const by_hand::MatrixXd& site, double momentum,
               Motors motors) {
  const Vector3d s = spin_axis(i);
  const by_hand::Index own = first_wheel + i;
  const by_hand::MatrixXd turn = site.bottomRows(3), move = site.topRows(3);
  by_hand::MatrixXd spin = s.transpose() * turn;  // about the axis, with its carrier's turn
  spin(0, own) += 1;
  a.M += wheel_mass * move.transpose() * move + axial * spin.transpose() * spin +
         transverse * turn.transpose() * (Eigen::Matrix3d::Identity() - s * s.transpose()) * turn;
  a.D -= momentum * turn.transpose() * cross_matrix(s) * turn;
  a.D(own, own) += friction;
  if (motors != Motors::off) {
    a.D.block(own, 3, 1, 3) -= law_c * allocation().row(i);
    a.K.block(own, 3, 1, 3) -= law_k * allocation().row(i);
  }
  if (motors == Motors::dumping) a.D.block(3, own, 3, 1) += dumped * axial * s;
  a.C(i, own) = 1;
  // Per cos and sin at 1 rad/s: a force along b and c, and the torque a x it, with b x c = a.
  const Vector3d b = s.cross(Vector3d::UnitZ()).normalized(), c = s.cross(b);
  Eigen::Matrix<double, 3, 2> u;
  u << b, c;
  a.B.middleCols(3 + 2 * i, 2) = move.transpose() * (imbalance.static_kgm * u) +
                                 turn.transpose() * (imbalance.dynamic_kgm2 * cross_matrix(s) * u);
}

/// Coordinates: hub and boom, angles of the wheels 18 to 21, with `vibration` the plate on its
/// springs 22 to 27. Outputs: the wheels' angles, the hub's. The law acts through the wheels.
by_hand::Structure satellite_by_hand(double momentum, Motors motors, bool vibration = false) {
  const by_hand::Index n = vibration ? 28 : 22;
  by_hand::Structure a = by_hand::empty(n, 3 + 2 * kWheels, 7);
  add_hub(a);
  by_hand::MatrixXd site = by_hand::MatrixXd::Zero(6, n);
  site.leftCols(6) = by_hand::tau(-wheel_at);
  if (vibration) {
    site.middleCols(on_springs, 6).setIdentity();
    by_hand::Matrix6 mass = by_hand::Matrix6::Zero();
    mass.diagonal() << Vector3d::Constant(plate_mass), Vector3d::Constant(plate_inertia);
    a.M += site.transpose() * mass * site;
    a.K.diagonal().tail(6) << Vector3d::Constant(mount_k), Vector3d::Constant(mount_turn_k);
    a.D.diagonal().tail(6) << Vector3d::Constant(mount_c), Vector3d::Constant(mount_turn_c);
  }
  for (int i = 0; i < kWheels; ++i) add_wheel(a, i, site, momentum, motors);
  a.B.block(3, 0, 3, 3).setIdentity();
  a.C.block(4, 3, 3, 3).setIdentity();
  return a;
}

double error_by_hand(const System& system, double momentum, Motors motors) {
  std::vector<by_hand::MatrixXcd> ours, right;
  for (const by_hand::Complex s : by_hand::ray(0.01, 30, 12)) {
    ours.push_back(system.transfer(s));
    right.push_back(by_hand::accel_transfer(satellite_by_hand(momentum, motors), s).leftCols(3));
    right.back().topRows(4) /= s;  // speeds
  }
  return by_hand::transfer_error(ours, right);
}

/// Turn of the line of sight, the hub's z axis, by a wheel's imbalance at its speed [rad]: that at
/// 1 rad/s times Omega^2, and the accelerations over Omega^2.
double sight(const Eigen::MatrixXcd& turn, int wheel) {
  const Eigen::Vector2cd turning(1, by_hand::Complex(0, -1));
  return (turn.block(0, 3 + 2 * wheel, 2, 2) * turning).norm();
}

/// Wheels on springs, speeds up to 6,000 rpm, each with its momentum: the sight at that speed.
bool vibration(const System& system) {
  double off = 0, worst = 0, at = 0;
  for (double omega = 20; omega <= 630; omega += 10) {
    const double h = axial * omega;
    const Eigen::MatrixXcd ours = system.update({{"h", h}}).transfer({0, omega}),
                           right = by_hand::accel_transfer(satellite_by_hand(h, Motors::off, true),
                                                           {0, omega})
                                       .bottomRows(3);
    for (int i = 0; i < kWheels; ++i)
      off = std::max(off, std::abs(sight(ours, i) / sight(right, i) - 1));
    if (sight(ours, 0) > worst) worst = sight(ours, 0), at = omega;
  }
  std::printf("imbalance of a wheel: turns the line of sight most, by %.2f nrad, at %.0f rad/s\n",
              1e9 * worst, at);
  return by_hand::agrees("line of sight over wheel speed", off, 1e-9);
}

/// The sight over frequency and wheel speed, of a force of 1 N that turns at the first wheel with
/// the torque of its imbalance. Without gnuplot the text files are still there.
void draw_waterfall(const System& system) {
  std::ofstream csv("waterfall.csv");
  std::vector<double> omega;
  for (double hertz = 4; hertz <= 60; hertz += 0.25) omega.push_back(2 * pi * hertz);
  for (int rpm = 0; rpm <= 6000; rpm += 250) {
    const System here = system.update({{"h", axial * rpm * 2 * pi / 60}});
    const std::vector<Eigen::MatrixXcd> H = here.frequency_response(omega);
    for (std::size_t k = 0; k < omega.size(); ++k)
      csv << rpm << ',' << omega[k] / (2 * pi) << ','
          << 1e9 * sight(H[k], 0) / imbalance.static_kgm / (omega[k] * omega[k]) << '\n';
    csv << '\n';
  }
  csv.close();
  std::ofstream("waterfall.gp") << R"(# gnuplot waterfall.gp: waterfall.csv to waterfall.svg
set terminal svg size 900,640 font "Helvetica,15" background rgb "white"
set output "waterfall.svg"
set datafile separator ","
set border 3 lw 1.2
set tics nomirror out scale 0.6,0.3
set xlabel "frequency [Hz]"
set ylabel "wheel speed [rpm]"
set xrange [4:60]
set yrange [-1200:7200]
set ytics 1000
set key top right
set title "turn of the line of sight: 300 nrad/N at the wheel speed, ten times as much 400 rpm above"
lift(r, x) = r + 400 * log10(x / 300)
plot for [i=24:0:-1] "waterfall.csv" every :::i::i using 2:(lift($1, $3)) \
  with lines lc rgb "#1d2f3f" lw 1 notitle, \
  [0:100] 60 * x with lines lc rgb "#d95f02" lw 2 dt (10,4) title "imbalance: frequency of the wheel"
)";
  if (std::system("gnuplot waterfall.gp 2>gnuplot.log") != 0)
    std::fprintf(stderr, "gnuplot is missing or failed: waterfall.svg is not drawn\n");
}

/// The slowest poles with torquers, beside those by hand, and the torquers' own gain.
bool dumping(double momentum) {
  const std::vector<by_hand::Complex> right =
      by_hand::poles(satellite_by_hand(momentum, Motors::dumping));
  const System system = compile(satellite(momentum, Motors::dumping));
  double off = 0;
  std::printf("with torquers: slowest poles");
  int count = 0;
  for (const Pole& p : system.poles()) {
    double nearest = HUGE_VAL;
    for (const by_hand::Complex& s : right) nearest = std::min(nearest, std::abs(s - p.s));
    off = std::max(off, nearest / p.omega);
    if (count++ < 3) std::printf(" %.5f%s", p.s.real(), p.pair ? " (pair)" : "");
  }
  std::printf(" 1/s, their gain %.5f\n", dumped);
  bool ok = by_hand::agrees("poles", off, 1e-6);
  return by_hand::agrees("with torquers", error_by_hand(system, momentum, Motors::dumping), 1e-9) &&
         ok;
}

/// Reduced models from torques on the hub to its accelerations, over the wheels' momenta, up to
/// four times the nominal one: M = I, K >= 0, D >= 0 and G = -G', within their bound of the model
/// by hand.
bool reduced_models() {
  const Scene scene{.outputs = {"turn"}, .band_hz = {0.01, 5}, .accuracy = 1e-3};
  bool ok = true;
  for (const double momentum : {0.0, 20.0, 40.0, 80.0, 160.0}) {
    const ReducedSystem reduced = compile(satellite(momentum, Motors::off), scene);
    const SecondOrderModel m = reduced.second_order();
    double error = 0, least = 0;  // over the bound; of the real part of torque times rate
    const double zeta = scene.damping_floor;
    for (double omega = 0.07; omega < 2 * pi * 5; omega *= 1.02) {
      const by_hand::Complex s(zeta * omega, std::sqrt(1 - zeta * zeta) * omega);
      const Eigen::MatrixXcd ours = reduced.transfer(s),
                             right = by_hand::accel_transfer(
                                         satellite_by_hand(momentum, Motors::off), s)
                                         .block(4, 0, 3, 3);
      const ErrorBound& bound = reduced.bound();
      error = std::max(
          error,
          ((ours - right).array().abs() / (bound.pairs.array() * bound.peak.array())).maxCoeff());
      const Eigen::MatrixXcd Y = ours / s;
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> power(Y + Y.adjoint());
      least = std::min(least, power.eigenvalues()(0) / Y.norm());
    }
    bool stable = true;
    for (const Pole& p : poles(reduced.state_space())) stable &= p.s.real() <= 1e-12;
    const bool skew = m.G == Eigen::MatrixXd(-m.G.transpose());
    std::printf("momentum %.0f N m s: reduced to %d states of %d, %s, G %s, %s, %s\n", momentum,
                reduced.order(), reduced.full().order(),
                error <= 1 ? "error within its bound" : "ERROR ABOVE ITS BOUND",
                m.G.isZero(0) ? "zero"
                : skew        ? "skew"
                              : "NOT SKEW",
                stable ? "stable" : "NOT STABLE", least >= -1e-9 ? "passive" : "NOT PASSIVE");
    ok = ok && error <= 1 && skew && stable && least >= -1e-9;
  }
  return ok;
}

}  // namespace

int main() {
  bool ok = true;
  for (const double momentum : {0.0, 40.0}) {
    const System free = compile(satellite(momentum, Motors::off));
    double nutation = 0;  // the slowest pole that oscillates
    for (const Pole& p : free.poles())
      if (nutation == 0 && p.pair && p.omega > 0.1) nutation = p.omega;
    std::printf(
        "momentum %.0f N m s in each wheel, motors off: order %d, slowest oscillation %.4f rad/s\n",
        momentum, free.state_space().order(), nutation);
    const FullCertificate c = certify(free);
    std::printf("passive: %s, reciprocal%s: %s\n", c.passivity.least >= -1e-9 ? "yes" : "no",
                c.reciprocity.reversed ? " with momenta reversed" : "",
                c.reciprocity.asymmetry <= 1e-9 ? "yes" : "no");
    ok = c.holds() && ok;
    const System held = compile(satellite(momentum, Motors::law));
    double slowest = -HUGE_VAL;
    for (const Pole& p : held.poles())
      if (p.omega > 1e-9) slowest = std::max(slowest, p.s.real());
    std::printf("with the law: order %d, %s\n", held.state_space().order(),
                slowest < 0 ? "stable" : "not stable");
    ok = slowest < 0 && ok;
    ok = by_hand::agrees("motors off", error_by_hand(free, momentum, Motors::off), 1e-9) && ok;
    ok = by_hand::agrees("with the law", error_by_hand(held, momentum, Motors::law), 1e-9) && ok;
    ok = dumping(momentum) && ok;
    const auto turned = free.transfer({0, 1e-3}).bottomRows(3).eval();
    std::printf(
        "at 0.001 rad/s 1 N m about x turns the hub with %.4f, %.4f, %.4f rad/s about x, y, z\n\n",
        std::abs(turned(0, 0)) / 1e-3, std::abs(turned(1, 0)) / 1e-3,
        std::abs(turned(2, 0)) / 1e-3);
  }
  const System on_plate = compile(satellite(0, Motors::off, true));
  ok = vibration(on_plate) && ok;
  draw_waterfall(on_plate);
  ok = reduced_models() && ok;
  return ok ? 0 : 1;
}
