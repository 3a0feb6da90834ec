// Poles of an ExactBeam with various ends against the roots of its frequency equations.
#include <doctest/doctest.h>

#include <numbers>
#include <vector>

#include "blocks/exact_beams.hpp"

using namespace exact_beams;
using namespace titop;
using Eigen::Index;

namespace {

constexpr Index kBending = 2;  ///< along z, with the section's I_y

/// The pole of this entry as beta L of unit_beam(), near `root`: 1 / H changes its sign there.
double pole_near(double root, const Diagram& d, Index row, Index column) {
  const System system = compile(d);
  const auto inverse = [&](double x) {
    return 1 / system.transfer({0, x * x})(row, column).real();
  };
  double low = root - 0.05, high = root + 0.05;
  const bool rises = inverse(high) > 0;
  REQUIRE(inverse(low) * inverse(high) < 0);
  try {
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      ((inverse(middle) > 0) == rises ? high : low) = middle;
    }
  } catch (const Error& error) {  // the pole to the last place
    REQUIRE(error.has(Code::singular));
  }
  return (low + high) / 2;
}

Diagram free_free() {
  Diagram d{"free"};
  auto b = d.add("b", unit_beam());
  b.parent.force = 0;
  drive_end(d, b);
  return d;
}

/// P turns about y alone.
void pin_root(BodyHandle& b) {
  b.parent.accel.linear = 0;
  b.parent.accel.angular.along(kX) = 0;
  b.parent.accel.angular.along(kZ) = 0;
}

Diagram pinned_free() {
  Diagram d{"pinned, free"};
  auto b = d.add("b", unit_beam());
  pin_root(b);
  b.parent.force.angular.along(kY) = 0;
  drive_end(d, b);
  return d;
}

Diagram pinned_pinned() {
  Diagram d{"pinned"};
  auto b = d.add("b", unit_beam());
  pin_root(b);
  b.parent.force.angular.along(kY) = -d.input("T");
  b.child.accel.linear.along(kZ) = 0;
  d.output("turn") = b.parent.accel.angular.along(kY);
  return d;
}

void check_roots(const Diagram& d, Index entry, const std::vector<double>& roots) {
  for (const double root : roots) {
    INFO(d.name() << ' ' << root);
    CHECK(std::abs(pole_near(root, d, entry, entry) - root) <= 1e-13 * root);
  }
}

}  // namespace

TEST_CASE("poles: the roots beta L of the textbooks") {
  check_roots(clamped(unit_beam()), kBending,
              {1.875104068711961, 4.694091132974175, 7.854757438237613, 10.99554073487547,
               14.13716839104647});
  check_roots(free_free(), kBending,
              {4.730040744862704, 7.853204624095838, 10.99560783800167, 14.13716549125746,
               17.27875965739948});
  check_roots(pinned_free(), kBending,
              {3.926602312047919, 7.068582745628732, 10.21017612281303, 13.35176877775409,
               16.49336143134641});
  using std::numbers::pi;
  check_roots(pinned_pinned(), 0, {pi, 2 * pi, 3 * pi, 10 * pi});
}
