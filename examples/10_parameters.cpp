// One plan, many values: a boom of which the tip mass and the spring at its root are parameters.
// `update` gives the system for other values; `sweep` does so on all cores; every model that comes
// out is the one that assembly by hand gives for its numbers.
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

double error(const System& system, double spring, double tip) {
  std::vector<by_hand::MatrixXcd> got, hand;
  for (const double w : {0.5, 6.0, 30.0, 90.0}) {
    const by_hand::Complex s{0.1 * w, w};
    got.push_back(system.transfer(s));
    hand.push_back(by_hand::accel_transfer(assembled(spring, tip), s));
  }
  return by_hand::transfer_error(got, hand);
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
    errors[i] = error(at, points[i][0].second, points[i][1].second);
  };
  sweep(system, points, each, {.progress = progress_line()});  // on a terminal
  std::printf("\n%12s %10s %12s\n", "spring [N/m]", "tip [kg]", "mode [Hz]");
  double worst = std::max(error(system, kSpring, kTip), error(heavy, kSpring, 8));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::printf("%12.0f %10.1f %12.4f\n", points[i][0].second, points[i][1].second, hertz[i]);
    worst = std::max(worst, errors[i]);
  }

  const by_hand::Complex s{0, 7};
  const double digits = (system.transfer(s) - system.transfer(s, Precision::twofold)).norm() /
                        system.transfer(s).norm();
  std::printf("\ntransfer in double against 32 digits: %s\n",
              digits <= 1e-14 ? "agrees" : "differs");

  // A model for a tool that wants A, B, C, D: in a buffer of one's own, and what writing it costs.
  StateSpace buffer;
  heavy.write(buffer);
  const double lost = heavy.certificate(buffer).dense_error;
  std::printf("written as A, B, C, D: %s\n", lost <= 1e-12 ? "12 digits or more" : "less");

  const bool ok = by_hand::agrees("all models against M and K", worst, 1e-12);
  return ok && digits <= 1e-14 && lost <= 1e-12 ? 0 : 1;
}
