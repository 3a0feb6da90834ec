// An arm of two links, which are beams as the partial differential equations have them: in closed
// form at every s, with all of their infinitely many modes. Its transfers are exact, and measure
// the error of finite models, and with it the elements and modes that an accuracy needs.
#include <cmath>
#include <cstdio>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/two_link_arm.hpp"

using namespace titop;
using namespace scenes::two_link_arm;

namespace {

/// All modes of links of so many elements.
System with_mesh(int elements) { return compile(arm_of(elements), {.minimize_up_to = 0}); }

void print_error(const char* text, int count, const System& finite, const System& exact) {
  std::printf("%s %2d: %3d states, error %.1e\n", text, count, finite.order(),
              compare(finite, exact, band).worst);
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
  const Diagram distributed = arm(upper, lower);
  const System exact = compile(distributed);
  std::printf("band: 0 to 50 Hz; errors against the distributed beams (estimates)\n");
  for (const int n : {2, 4, 8, 16}) print_error("all modes, elements", n, with_mesh(n), exact);
  for (const double accuracy : {1e-2, 1e-3}) {
    Scene scene = band;
    scene.accuracy = accuracy;
    std::printf("accuracy %.0e\n%s", accuracy, to_string(reduce_beams(distributed, scene)).c_str());
  }
  const double off = limit_of_meshes(exact);
  return by_hand::agrees("tip by hub at s = 2 + 60j, against the limit of meshes", off, 1e-6) ? 0
                                                                                              : 1;
}
