// An arm of two links, which are beams as the partial differential equations have them: in closed
// form at every s, with all of their infinitely many modes. Its transfers are exact, and measure
// the error of finite models, and with it the elements and modes that an accuracy needs.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

const ExactBeam kUpper{.length = 3,
                       .section = tube(0.08, 0.07),
                       .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                       .damping = {.mass = 0.02, .stiffness = 2e-5}};
const ExactBeam kLower{.length = 2,
                       .section = tube(0.05, 0.042),
                       .material = kUpper.material,
                       .damping = kUpper.damping};
const Scene kBand{.band_hz = {0, 50}};

/// The arm on a free hub, with links of any kind; the elbow is a hinge on a spring.
template <class Link>
Diagram arm(Link upper_link, Link lower_link) {
  Diagram d{"arm"};
  auto hub = d.add("hub", RigidBody{.mass = 60,
                                    .inertia = Vector3d(5, 6, 7).asDiagonal(),
                                    .children = {{"arm", {0.4, 0, 0}}}});
  auto upper = d.add("upper", upper_link), lower = d.add("lower", lower_link);
  auto hand = d.add("hand", RigidBody{.mass = 3, .inertia = 0.02 * Matrix3d::Identity()});
  hub.parent.force = -d.input("F", 6);  // [N; N m]
  mount(upper, hub.child("arm"));
  const Vector3d z(0, 0, 1);
  auto elbow = hinge(d, "elbow", lower, upper.child("C"), Rotation::about(z, 0.7), z);
  elbow.torque = 900 * elbow.angle + 4 * elbow.rate;
  mount(hand, lower.child("C"));
  d.output("hub", 6) = hub.parent.accel;
  d.output("hand", 6) = hand.parent.accel;
  return d;
}

/// All modes of links of so many elements.
System with_mesh(int elements) {
  return compile(arm(FlexibleBody{with_elements(kUpper, elements)},
                     FlexibleBody{with_elements(kLower, elements)}),
                 {.minimize_up_to = 0});
}

void print_error(const char* text, int count, const System& finite, const System& exact) {
  std::printf("%s %2d: %3d states, error %.1e\n", text, count, finite.order(),
              compare(finite, exact, kBand).worst);
}

/// The error of the refined mesh at the tip, extrapolated: it falls with h^4.
double limit_of_meshes(const System& exact) {
  const std::complex<double> s(2, 60);
  const auto at = [&](int n) { return with_mesh(n).transfer(s)(7, 1); };
  const std::complex<double> fine = at(24), limit = fine + (fine - at(12)) / 15.0;
  return std::abs(limit / exact.transfer(s)(7, 1) - 1.0);
}

}  // namespace

int main() {
  const Diagram distributed = arm(kUpper, kLower);
  const System exact = compile(distributed);
  std::printf("band: 0 to 50 Hz; errors against the distributed beams (estimates)\n");
  for (const int n : {2, 4, 8, 16}) print_error("all modes, elements", n, with_mesh(n), exact);
  for (const double accuracy : {1e-2, 1e-3}) {
    Scene scene = kBand;
    scene.accuracy = accuracy;
    std::printf("accuracy %.0e\n%s", accuracy, to_string(reduce_beams(distributed, scene)).c_str());
  }
  const double off = limit_of_meshes(exact);
  return by_hand::agrees("tip by hub at s = 2 + 60j, against the limit of meshes", off, 1e-6) ? 0
                                                                                              : 1;
}
