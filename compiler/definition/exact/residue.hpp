#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace titop::exact {

/// Internal exception: the reason why the order is not decided.
struct Undecided {
  std::string why;
};

/// A rational number modulo two primes of 60 bits: sums, products and quotients without rounding in
/// constant time. It is 0 if both residues are. The primes were drawn at random: b / 60 primes at
/// most divide an integer of b bits, of 10^16, so that a number other than 0 with b bits in its
/// numerator is taken as 0 with a probability below (b / 2^59)^2. If only one prime divides it, a
/// division by it throws Undecided.
class Residue {
 public:
  Residue() = default;
  Residue(int value);  // NOLINT(google-explicit-constructor): 0 and 1 in sums
  /// Every finite double is a fraction whose denominator is a power of two.
  explicit Residue(double value);

  Residue& operator+=(const Residue& x);
  Residue& operator-=(const Residue& x);
  Residue& operator*=(const Residue& x);
  Residue operator-() const { return Residue() -= *this; }
  Residue inverse() const;

  friend Residue operator+(Residue a, const Residue& b) { return a += b; }
  friend Residue operator-(Residue a, const Residue& b) { return a -= b; }
  friend Residue operator*(Residue a, const Residue& b) { return a *= b; }
  friend bool operator==(const Residue&, const Residue&) = default;

  static constexpr std::array<std::uint64_t, 2> kPrimes = {1971744998650646431,
                                                           1257016797140774239};

 private:
  std::array<std::uint64_t, 2> at_{};  ///< modulo each prime
};

}  // namespace titop::exact
