#pragma once

#include <span>
#include <string>

namespace titop {

/// The numbers that a diagram's parameters have, by index.
using ParameterValues = std::span<const double>;

/// Handle of a parameter of a diagram: `auto k1 = d.param("k1", 10.0)`.
struct Param {
  int index = -1;               ///< position among the diagram's parameters
  double nominal = 0;           ///< the value given when it was made
  const void* owner = nullptr;  ///< its diagram's graph
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
  const void* owner() const { return owner_; }

 private:
  double number_ = 0;
  double scale_ = 1;
  int index_ = -1;
  const void* owner_ = nullptr;
};

inline Value operator-(const Param& p) { return {-1, p}; }
inline Value operator*(double scale, const Param& p) { return {scale, p}; }
inline Value operator*(const Param& p, double scale) { return {scale, p}; }
inline Value operator/(const Param& p, double divisor) { return {1 / divisor, p}; }

}  // namespace titop
