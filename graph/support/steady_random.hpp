#pragma once

namespace titop::detail {

/// Numbers in [-1, 1] from a fixed seed [Marsaglia 2003, xorshift]: checks with them are the same
/// on every run and every machine.
class SteadyRandom {
 public:
  SteadyRandom() = default;
  /// Another sequence for each number.
  explicit SteadyRandom(int sequence) {
    state_ ^= static_cast<unsigned long long>(sequence) * 0xD1B54A32D192ED03ull;
  }

  double next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
  }

  /// A number of either sign and magnitude 0.5 to 1: two of them do not cancel to 0, as +1 and -1
  /// do.
  double unit() {
    const double x = next();
    return x < 0 ? (x - 1) / 2 : (x + 1) / 2;
  }

 private:
  unsigned long long state_ = 0x9E3779B97F4A7C15ull;
};

}  // namespace titop::detail
