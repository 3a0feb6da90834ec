#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

/// Random numbers of scenes: the same with every compiler and standard library. The standard
/// defines the engines of <random> to the bit, its distributions and std::shuffle not.
namespace titop::generate {

/// 64 random bits a call [Steele, Lea, Flood 2014].
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t operator()() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

/// Numbers from 64 random bits at a time, by correctly rounded operations alone. Each draw is a
/// statement of its own, a declarator, or an item in braces: the arguments of a call and the
/// operands of a product have no order.
template <class Bits>
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : bits_(seed) {}

  std::uint64_t bits() { return bits_(); }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// One of 0 ... n - 1.
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
  bool chance(double p) { return unit() < p; }
  double sign() { return chance(0.5) ? 1 : -1; }
  /// Spread over the powers of two from 2^low to 2^high, without a logarithm's last digit.
  double octaves(int low, int high) {
    const double mantissa = between(1, 2);
    return std::ldexp(mantissa, low + below(high - low));
  }
  /// Entries in [-1, 1), column by column.
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index j = 0; j < cols; ++j)
      for (Eigen::Index i = 0; i < rows; ++i) m(i, j) = between(-1, 1);
    return m;
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    for (int i = static_cast<int>(list.size()) - 1; i > 0; --i)
      std::swap(list[static_cast<std::size_t>(i)], list[static_cast<std::size_t>(below(i + 1))]);
  }
  /// Proper rotation from a random quaternion, orthogonal to rounding.
  Eigen::Matrix3d rotation() {
    Eigen::Vector4d q;
    do q = matrix(4, 1);
    while (q.squaredNorm() < 0.1 || q.squaredNorm() > 1);
    q /= std::sqrt(q.squaredNorm());
    const double w = q(0), x = q(1), y = q(2), z = q(3);
    Eigen::Matrix3d T;
    T << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
        1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
        1 - 2 * (x * x + y * y);
    return T;
  }

 private:
  Bits bits_;
};

using Rng = Draws<SplitMix64>;
using Mersenne = Draws<std::mt19937_64>;

}  // namespace titop::generate
