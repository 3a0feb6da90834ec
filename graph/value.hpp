#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

namespace titop {

/// The numbers that a diagram's parameters have, by index.
using ParameterValues = std::span<const double>;

/// Handle of a parameter of a diagram: `auto k1 = d.param("k1", 10.0)`.
struct Param {
  int index = -1;           ///< position among the diagram's parameters
  double nominal = 0;       ///< the value given when it was made
  std::uint64_t owner = 0;  ///< Graph::id of its diagram
};

/// A number, or a parameter: wherever a block takes a number, it takes a `Value`, so
/// `SpringMass{.mass = 2.0, .stiffness = k1}` is valid for both.
class Value {
 public:
  constexpr Value(double number = 0) : number_(number) {}
  Value(const Param& p) : Value(1, p) {}
  /// Throws unknown_name for a Param that no diagram has made.
  Value(double scale, const Param& p);

  /// The number for these parameter values. O(1).
  double at(ParameterValues values) const {
    return index_ < 0 ? number_ : scale_ * values[static_cast<std::size_t>(index_)];
  }
  /// The number given by the user, or the value at the parameter's nominal value.
  double nominal() const { return scale_ * number_; }
  /// Factor of the parameter: `-k` has -1, `2 * k` has 2.
  double scale() const { return scale_; }
  /// The parameter's own nominal value.
  double parameter() const { return number_; }
  bool is_parameter() const { return index_ >= 0; }
  int index() const { return index_; }
  std::uint64_t owner() const { return owner_; }

  friend Value operator*(double scale, Value v) { return v.times(scale); }
  friend Value operator*(Value v, double scale) { return v.times(scale); }
  friend Value operator/(Value v, double divisor) { return v.times(1 / divisor); }
  friend Value operator-(Value v) { return v.times(-1); }

 private:
  Value times(double scale) const {
    Value v = *this;
    (is_parameter() ? v.scale_ : v.number_) *= scale;
    return v;
  }

  double number_ = 0;
  double scale_ = 1;
  int index_ = -1;
  std::uint64_t owner_ = 0;
};

inline Value operator-(const Param& p) { return {-1, p}; }
inline Value operator*(double scale, const Param& p) { return {scale, p}; }
inline Value operator*(const Param& p, double scale) { return {scale, p}; }
inline Value operator/(const Param& p, double divisor) { return {1 / divisor, p}; }

namespace detail {

template <class>
constexpr bool never = false;

/// A parameter, or a multiple of one.
template <class T>
concept Parametric = std::same_as<T, Param> || std::same_as<T, Value>;

/// A constant of an equation: a number or a parameter.
template <class T>
concept Constant = std::is_arithmetic_v<T> || Parametric<T>;

/// Two constants whose product, sum or quotient would be a function of parameters.
template <class L, class R>
concept ConstantsWithParameter = Constant<L> && Constant<R> && (Parametric<L> || Parametric<R>);

}  // namespace detail

// A `Value` is a number, or a number times one parameter: other functions of parameters are
// refused, with the text to write instead.

template <detail::Parametric L, detail::Parametric R>
Value operator*(const L&, const R&) {
  static_assert(detail::never<L>,
                "titop: a product of two parameters p, q is not a parameter. "
                "For a signal x write p * (q * x); for a block declare d.param(\"pq\", number).");
  return {};
}
template <class L, class R>
  requires detail::ConstantsWithParameter<L, R>
Value operator+(const L&, const R&) {
  static_assert(
      detail::never<L>,
      "titop: a sum with a parameter p is not a parameter. "
      "For a signal x write p * x + q * x; for a block declare d.param(\"sum\", number).");
  return {};
}
template <class L, class R>
  requires detail::ConstantsWithParameter<L, R>
Value operator-(const L&, const R&) {
  static_assert(
      detail::never<L>,
      "titop: a difference with a parameter p is not a parameter. "
      "For a signal x write p * x - q * x; for a block declare d.param(\"diff\", number).");
  return {};
}
template <detail::Constant L, detail::Parametric R>
Value operator/(const L&, const R&) {
  static_assert(detail::never<L>,
                "titop: a quotient by a parameter p is not a parameter. "
                "Declare the reciprocal, r = d.param(\"r\", 1 / number), and multiply by r.");
  return {};
}

}  // namespace titop
