#include <cmath>
#include <titop/compiler/definition/exact/residue.hpp>

namespace titop::exact {
namespace {

__extension__ typedef unsigned __int128 Wide;

std::uint64_t product(std::uint64_t a, std::uint64_t b, std::uint64_t prime) {
  return static_cast<std::uint64_t>(Wide{a} * b % prime);
}

std::uint64_t power(std::uint64_t base, std::uint64_t exponent, std::uint64_t prime) {
  std::uint64_t result = 1;
  for (; exponent > 0; exponent /= 2, base = product(base, base, prime))
    if (exponent % 2 != 0) result = product(result, base, prime);
  return result;
}

/// [Fermat]: a^(p - 1) = 1 modulo a prime p.
std::uint64_t inverse_of(std::uint64_t a, std::uint64_t prime) {
  return power(a, prime - 2, prime);
}

}  // namespace

Residue::Residue(int value) {
  for (std::size_t k = 0; k < at_.size(); ++k)
    at_[k] = value < 0 ? kPrimes[k] - static_cast<std::uint64_t>(-value)
                       : static_cast<std::uint64_t>(value);
}

Residue::Residue(double value) {
  if (value == 0) return;
  int exponent = 0;
  const auto mantissa =
      static_cast<std::uint64_t>(std::ldexp(std::abs(std::frexp(value, &exponent)), 53));
  exponent -= 53;
  for (std::size_t k = 0; k < at_.size(); ++k) {
    const std::uint64_t prime = kPrimes[k];
    const std::uint64_t two = exponent < 0 ? (prime + 1) / 2 : 2;  // its inverse, or itself
    at_[k] = product(mantissa % prime,
                     power(two, static_cast<std::uint64_t>(std::abs(exponent)), prime), prime);
  }
  if (value < 0) *this = -*this;
}

Residue& Residue::operator+=(const Residue& x) {
  for (std::size_t k = 0; k < at_.size(); ++k) {
    at_[k] += x.at_[k];
    if (at_[k] >= kPrimes[k]) at_[k] -= kPrimes[k];
  }
  return *this;
}

Residue& Residue::operator-=(const Residue& x) {
  for (std::size_t k = 0; k < at_.size(); ++k)
    at_[k] = at_[k] >= x.at_[k] ? at_[k] - x.at_[k] : at_[k] + kPrimes[k] - x.at_[k];
  return *this;
}

Residue& Residue::operator*=(const Residue& x) {
  for (std::size_t k = 0; k < at_.size(); ++k) at_[k] = product(at_[k], x.at_[k], kPrimes[k]);
  return *this;
}

Residue Residue::inverse() const {
  Residue result;
  for (std::size_t k = 0; k < at_.size(); ++k) {
    if (at_[k] == 0) throw Undecided{"a number is a multiple of a prime that counts modulo it"};
    result.at_[k] = inverse_of(at_[k], kPrimes[k]);
  }
  return result;
}

}  // namespace titop::exact
