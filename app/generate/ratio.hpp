#pragma once

#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

/// Exact numbers of a random scene. Lengths, masses and frequencies are multiples of a power of
/// two, so that the double in the file is the number meant; rotations and unit vectors come from
/// whole numbers (3-4-5 and the like), where the file has the nearest double.
namespace titop::generate {

/// num / den in lowest terms, den > 0. Throws std::overflow_error.
struct Ratio {
  std::int64_t num = 0, den = 1;

  Ratio(std::int64_t n = 0, std::int64_t d = 1) {
    const std::int64_t common = std::gcd(n, d) * (d < 0 ? -1 : 1);
    num = n / common, den = d / common;
  }
  double value() const { return static_cast<double>(num) / static_cast<double>(den); }
};

inline std::int64_t times(std::int64_t a, std::int64_t b) {
  std::int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) throw std::overflow_error("Ratio");
  return product;
}
inline Ratio operator*(const Ratio& a, const Ratio& b) {
  const Ratio x{a.num, b.den}, y{b.num, a.den};  // reduced first
  return {times(x.num, y.num), times(x.den, y.den)};
}
inline Ratio operator+(const Ratio& a, const Ratio& b) {
  const std::int64_t common = std::gcd(a.den, b.den);
  const std::int64_t left = times(a.num, b.den / common), right = times(b.num, a.den / common);
  std::int64_t sum = 0;
  if (__builtin_add_overflow(left, right, &sum)) throw std::overflow_error("Ratio");
  return {sum, times(a.den, b.den / common)};
}
inline Ratio operator-(const Ratio& a) { return {-a.num, a.den}; }
inline Ratio operator-(const Ratio& a, const Ratio& b) { return a + -b; }
inline bool operator==(const Ratio& a, const Ratio& b) { return a.num == b.num && a.den == b.den; }

}  // namespace titop::generate
