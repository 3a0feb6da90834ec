// One plan, many values: a boom of which the tip mass and the spring at its root are parameters.
// `update` gives the system for other values; `sweep` does so on all cores; every model agrees with
// assembly by hand at the same values. Then a wing with one uncertain mode: its frequency and
// damping ratio are parameters, as is the inertia of its hub.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

constexpr double kHub = 50, kBoom = 4, kSpring = 300, kTip = 2;

/// Hub (free) - spring - boom - stiff spring - tip, on one axis.
Diagram scene() {
  Diagram d{"boom"};
  const Param spring = d.param("spring", kSpring);  // [N/m]
  const Param tip = d.param("tip", kTip);           // [kg]
  auto u = d.input("u");
  auto root = d.add("root", SpringMass{.mass = kBoom, .stiffness = spring, .parent_mass = kHub});
  auto end = d.add("end", SpringMass{.mass = tip, .stiffness = 5000});
  root.parent.force = -u;
  mount(end, root.child);
  d.output("hub") = root.parent.accel;
  d.output("tip") = end.child.accel;
  return d;
}

by_hand::Structure assembled(double spring, double tip) {
  by_hand::Structure a = by_hand::empty(3, 1, 2);
  a.M.diagonal() << kHub, kBoom, tip;
  a.K << spring, -spring, 0, -spring, spring + 5000, -5000, 0, -5000, 5000;
  a.B << 1, 0, 0;
  a.C << 1, 0, 0, 0, 0, 1;
  return a;
}

double error(const System& system, const by_hand::Structure& assembled) {
  std::vector<by_hand::MatrixXcd> got, hand;
  for (const double w : {0.5, 6.0, 30.0, 90.0}) {
    const by_hand::Complex s{0.1 * w, w};
    got.push_back(system.transfer(s));
    hand.push_back(by_hand::accel_transfer(assembled, s));
  }
  return by_hand::transfer_error(got, hand);
}

/// A wing along x of 12 kg and 16 kg m^2 about its root P, bending in y.
ModalData one_mode() {
  ModalData data;
  data.omega = Eigen::VectorXd::Constant(1, 3);   // [rad/s]
  data.xi = Eigen::VectorXd::Constant(1, 0.005);  // [-]
  data.L_P = Eigen::RowVector<double, 6>(0, 2.7, 0, 0, 0, 3.9);
  data.D_P = rigid_mass(12, Vector3d(0, 4, 4).asDiagonal(), Vector3d(-1, 0, 0));
  return data;
}

/// Hub (free) and wing.
Diagram winged() {
  Diagram d{"winged"};
  const Param omega = d.param("omega", 3.0), xi = d.param("xi", 0.005);  // [rad/s], [-]
  const Param spin = d.param("spin", 9.0);                               // about z [kg m^2]
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = kHub, .inertia = {8, 8, spin}, .children = {{"root"}}});
  auto wing = d.add("wing", FlexibleBody{one_mode(), {.omega = {{1, omega}}, .xi = {{1, xi}}}});
  hub.parent.force = -U;
  mount(wing, hub.child);
  d.output("hub", 6) = hub.parent.accel;
  return d;
}

by_hand::Structure winged_by_hand(double omega, double xi, double spin) {
  by_hand::Structure a = by_hand::empty(7, 6, 6);
  a.M.diagonal() << kHub + 12, kHub + 12, kHub + 12, 8, 8 + 16, spin + 16, 1;
  a.M(1, 5) = a.M(5, 1) = 12 * 1;  // the wing's centre of mass, 1 m out
  a.M(2, 4) = a.M(4, 2) = -12 * 1;
  a.M(1, 6) = a.M(6, 1) = 2.7;
  a.M(5, 6) = a.M(6, 5) = 3.9;
  a.D(6, 6) = 2 * xi * omega;
  a.K(6, 6) = omega * omega;
  a.B.topRows(6).setIdentity();
  a.C.leftCols(6).setIdentity();
  return a;
}

}  // namespace

int main() {
  const System system = compile(scene());
  const System heavy = system.update({{"tip", 8.0}});
  std::printf("%-22s %8s %8s\n", "slow mode [Hz]", "tip 2 kg", "tip 8 kg");
  std::printf("%-22s %8.4f %8.4f\n", "", system.poles().front().hertz, heavy.poles().front().hertz);

  std::vector<ParameterList> points;
  for (int i = 1; i <= 9; ++i) points.push_back({{"spring", 100.0 * i}, {"tip", 0.5 * i}});
  std::vector<double> hertz(points.size()), errors(points.size());
  const auto each = [&](std::size_t i, const System& at) {
    hertz[i] = at.poles().front().hertz;
    errors[i] = error(at, assembled(points[i][0].second, points[i][1].second));
  };
  sweep(system, points, each, {.progress = progress_line()});  // on a terminal
  std::printf("\n%12s %10s %12s\n", "spring [N/m]", "tip [kg]", "mode [Hz]");
  double worst =
      std::max(error(system, assembled(kSpring, kTip)), error(heavy, assembled(kSpring, 8)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::printf("%12.0f %10.1f %12.4f\n", points[i][0].second, points[i][1].second, hertz[i]);
    worst = std::max(worst, errors[i]);
  }

  const System wing = compile(winged());
  const System other = wing.update({{"omega", 2.4}, {"xi", 0.02}, {"spin", 7.0}});
  std::printf("\nwing at 3 rad/s: mode of %.4f Hz, at 2.4 rad/s on a smaller hub: %.4f Hz\n",
              wing.poles().back().hertz, other.poles().back().hertz);
  worst = std::max({worst, error(wing, winged_by_hand(3, 0.005, 9)),
                    error(other, winged_by_hand(2.4, 0.02, 7))});

  const by_hand::Complex s{0, 7};
  const double digits = (system.transfer(s) - system.transfer(s, Precision::twofold)).norm() /
                        system.transfer(s).norm();
  std::printf("\ntransfer in double against 32 digits: %s\n",
              digits <= 1e-14 ? "agrees" : "differs");

  // A model for a tool that needs A, B, C, D: in the caller's buffer, with the accuracy lost by
  // writing it.
  StateSpace buffer;
  heavy.write(buffer);
  const double lost = heavy.certificate(buffer).dense_error;
  std::printf("written as A, B, C, D: %s\n", lost <= 1e-12 ? "12 digits or more" : "less");

  const bool ok = by_hand::agrees("all models against M and K", worst, 1e-12);
  return ok && digits <= 1e-14 && lost <= 1e-12 ? 0 : 1;
}
