// No more states than the scene needs: the satellite of scenes/satellite.cpp, its booms two beams
// of 60 modes each, on a rigid hub, one of them on a spring hinge. The scene: inputs are a wheel on
// the hub and the motor of the hinge, outputs the motion of the hub and of one tip, up to 100 Hz,
// to one part in a thousand. The result is a small model with a bound on its error.
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"

using namespace titop;

namespace {

FlexibleBody boom() {
  return Beam{.length = 2,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = 10,
              .modes = {.xi = {0.005}}};
}

/// [hub's rotations; tip2; theta] from [the wheel about z; the motor], by hand.
by_hand::MatrixXcd asked(const by_hand::Structure& a, by_hand::Complex s) {
  by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
  G.topRows(18) *= s * s;  // accelerations; theta is an angle
  by_hand::MatrixXcd H(10, 2);
  H << G.middleRows(3, 3).col(5), G.middleRows(3, 3).col(6), G.bottomRows(7).col(5),
      G.bottomRows(7).col(6);
  return H;
}

/// Largest error of any pair, each over its own peak, against the scene assembled by hand.
double error_by_hand(const ReducedSystem& r, const by_hand::Structure& a, const Scene& scene) {
  std::vector<by_hand::MatrixXcd> small, exact;
  for (const by_hand::Complex s : by_hand::ray(scene.damping_floor, scene.band_hz[1], 400))
    small.push_back(r.transfer(s)), exact.push_back(asked(a, s));
  return by_hand::transfer_error(small, exact);
}

}  // namespace

int main() {
  const FlexibleBody beam = boom();
  const Diagram d = scenes::satellite(beam);
  const Scene scene{.inputs = {"W(6)", "tau_m"},
                    .outputs = {"hub(4)", "hub(5)", "hub(6)", "tip2", "theta"},
                    .band_hz = {0, 100},
                    .accuracy = 1e-3};
  const ReducedSystem r = compile(d, scene);
  std::printf("%s: %d states instead of %d\n", d.name().c_str(), r.order(), r.full().order());
  for (const ReductionStep& s : r.steps())
    std::printf("  %s: %d -> %d coordinates, %s\n", s.name.c_str(), s.before, s.after,
                s.error == 0 ? "exact" : s.text.c_str());
  bool ok = r.bound().worst <= scene.accuracy;
  std::printf("bound below 1e-3: %s\n", ok ? "yes" : "NO");
  ok &= by_hand::agrees("against M, D and K by hand",
                        error_by_hand(r, scenes::satellite_by_hand(beam.data()), scene), 1e-3);

  std::printf("\nkept modes below 120 Hz\n");
  for (const KeptMode& m : r.modes()) {
    if (m.hertz >= 120) continue;
    std::printf("  %8.3f Hz ", m.hertz);
    for (const auto& [name, share] : m.blocks)
      std::printf(" %s %.0f %%", name.c_str(), 100 * share);
    std::printf("\n");
  }

  std::printf("\naccuracy  states\n");
  const std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
  for (const WhatIf& w : what_if(d, scene, accuracies))
    std::printf("%8.0e  %6d\n", w.accuracy, w.order);

  // Its inputs and outputs are the full system's: one can replace the other.
  const SecondOrderModel m = r.second_order();
  std::printf("\nM, D, K: %ld x %ld; modal: %zu blocks of 2 x 2; dense: %d states\n",
              static_cast<long>(m.K.rows()), static_cast<long>(m.K.cols()), r.modal().A.size(),
              r.state_space().order());
  ok &= r.inputs() == r.full().inputs() && r.outputs() == r.full().outputs();
  return ok ? 0 : 1;
}
