// The worst of ten thousand satellites: that of the demo (scenes/satellite.cpp), of which the tilt
// of the driven boom, the mass of the hub and the first frequency of that boom are uncertain. One
// compile takes the three parameters out; at each frequency the transfer of the opened model is
// computed once, and closing it for a satellite costs the solution of a system as large as the
// parameters' occurrences. The nominal satellite is the one assembled by hand, the worst one is
// compiled again. Then the same with fewer states: the opened model reduced over a band, with a
// bound on the error of each satellite.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"

using namespace titop;

namespace {

constexpr int kSamples = 10000;

/// Torque of the motor to the turn of the hub.
Diagram satellite(const FlexibleBody& boom) {
  Diagram d{"satellite"};
  const Param m = d.param("m", 85), tilt = d.param("tilt", scenes::angle2),
              w1 = d.param("w1", boom.data().omega(0));
  RigidBody uncertain = scenes::hub_spec;
  uncertain.mass = m;
  auto tau_m = d.input("tau_m");
  auto hub = d.add("hub", uncertain);
  auto boom1 = d.add("boom1", boom);
  auto boom2 = d.add("boom2", FlexibleBody{boom, {.omega = {{1, w1}}}});
  hub.parent.force = 0;
  mount(boom1, hub.child("C1"), Rotation::about(scenes::turn1, scenes::angle1));
  auto drive = hinge(d, "drive", boom2, hub.child("C2"), Rotation::about(scenes::turn2, tilt),
                     scenes::hinge_axis);
  drive.torque = scenes::kappa * drive.angle + scenes::c * drive.rate - tau_m;
  d.output("turn", 3) = hub.parent.accel.angular;
  return d;
}

/// M reduced up to 20 Hz: its states, and the error of a hundred satellites against its bound.
bool reduced_keeps_its_bound(const Lft& f, const std::vector<ParameterList>& samples) {
  const ReducedLft r = reduce(f, {.band_hz = {0.1, 20}, .accuracy = 1e-3});
  int kept = 0, all = 0;
  for (const double omega : {1.0, 10.0, 40.0, 100.0}) {
    const std::complex<double> s = r.on_ray(omega);
    for (std::size_t i = 0; i < 25; ++i, ++all) {
      const Eigen::MatrixXd off =
          (f.at(samples[i]).transfer(s) - r.lft().at(samples[i]).transfer(s)).cwiseAbs();
      kept += (off.array() <= r.error(omega, samples[i]).array()).all();
    }
  }
  std::printf(
      "\nup to 20 Hz with an error of 1e-3 of M: %d of %d states; %d of %d samples within "
      "their bounds\n",
      r.lft().m().order(), f.m().order(), kept, all);
  return kept == all;
}

}  // namespace

int main() {
  const FlexibleBody boom = scenes::read_boom();
  const System system = compile(satellite(boom));
  const Lft f = lft(system, {{"m", percent(20)}, {"tilt", between(2.2, 3.6)}, {"w1", percent(10)}});
  std::printf("%s\n", to_string(f).c_str());

  std::mt19937 random(1);
  std::vector<ParameterList> samples(kSamples);
  for (ParameterList& p : samples)
    for (const Delta& d : f.deltas())
      p.emplace_back(d.parameter,
                     d.map.value(2 * (static_cast<double>(random()) / 4294967296.0) - 1));

  double off_by_hand = 0, off_worst = 0, seconds = 0;
  std::printf("%10s %12s %12s   at\n", "rad/s", "nominal", "worst");
  for (const double omega : {1.0, 10.0, 40.0, 100.0}) {
    const by_hand::Complex s{0, omega};
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Eigen::MatrixXcd> all = f.transfers(s, samples);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto worst = std::max_element(
        all.begin(), all.end(), [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
    const ParameterList& p = samples[static_cast<std::size_t>(worst - all.begin())];
    const std::vector<ParameterList> none(1);
    const Eigen::MatrixXcd nominal = f.transfers(s, none)[0];
    std::printf("%10.0f %12.4g %12.4g   m = %.1f, tilt = %.2f, w1 = %.1f\n", omega, nominal.norm(),
                worst->norm(), p[0].second, p[1].second, p[2].second);
    const by_hand::MatrixXcd by_hand_all =
        by_hand::accel_transfer(scenes::satellite_by_hand(boom.data()), s);
    off_by_hand =
        std::max(off_by_hand, by_hand::transfer_error({nominal}, {by_hand_all.block(3, 6, 3, 1)}));
    off_worst =
        std::max(off_worst, by_hand::transfer_error({*worst}, {system.update(p).transfer(s)}));
  }
  std::fprintf(stderr, "%d satellites closed in %.1f ms per frequency; errors %.1e, %.1e\n",
               kSamples, 1e3 * seconds / 4, off_by_hand, off_worst);
  const bool reduced = reduced_keeps_its_bound(f, samples);
  const bool ok = by_hand::agrees("nominal satellite against M, D, K", off_by_hand, 1e-9);
  return by_hand::agrees("worst satellites against update", off_worst, 1e-9) && ok && reduced ? 0
                                                                                              : 1;
}
