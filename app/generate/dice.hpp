#pragma once

#include "generate/draws.hpp"
#include "generate/plan.hpp"

namespace titop::generate {

/// Whole numbers and ratios of them.
class Dice : public Mersenne {
 public:
  using Mersenne::Mersenne;
  int between(int low, int high) { return low + below(high - low + 1); }
  bool chance(int percent) { return below(100) < percent; }
  /// From 2^low to 2^high, five bits.
  Ratio octaves(int low, int high) {
    const std::int64_t mantissa = 16 + below(16);
    const int e = low + below(high - low) - 4;
    return e >= 0 ? Ratio(mantissa << e) : Ratio(mantissa, std::int64_t(1) << -e);
  }
  /// From -1 to 1 in steps of 1/64.
  Ratio fraction() { return {between(-64, 64), 64}; }
  Vec3 vector() { return {fraction(), fraction(), fraction()}; }
  /// Rational rotations from whole quaternions: quarter turns and 3-4-5.
  Mat3 rotation() {
    static constexpr int kQuaternions[][4] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 0, 1, 0},
                                              {1, 0, 0, 1}, {1, 1, 1, 1}, {0, 1, 0, 0},
                                              {2, 1, 0, 0}, {2, 0, 1, 0}, {2, 0, 0, -1}};
    const auto& k = kQuaternions[below(9)];
    const std::int64_t w = k[0], x = k[1], y = k[2], z = k[3], n = w * w + x * x + y * y + z * z;
    const auto row = [n](std::int64_t a, std::int64_t b, std::int64_t c) {
      return Vec3{Ratio(a, n), Ratio(b, n), Ratio(c, n)};
    };
    return {row(w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            row(2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
            row(2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z)};
  }
  Vec3 direction() {
    static const Vec3 kDirections[] = {{1, 0, 0},
                                       {0, 1, 0},
                                       {0, 0, 1},
                                       {Ratio(3, 5), 0, Ratio(4, 5)},
                                       {0, Ratio(-4, 5), Ratio(3, 5)},
                                       {Ratio(1, 3), Ratio(2, 3), Ratio(2, 3)},
                                       {Ratio(2, 7), Ratio(-3, 7), Ratio(6, 7)}};
    return kDirections[below(7)];
  }
};

}  // namespace titop::generate
