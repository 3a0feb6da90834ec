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

/// A number, or a parameter that stands for one: wherever a block takes a number, it takes a
/// `Value`, so `SpringMass{.mass = 2.0, .stiffness = k1}` needs no second spelling.
class Value {
 public:
  constexpr Value(double number = 0) : number_(number) {}
  Value(const Param& p) : number_(p.nominal), index_(p.index), owner_(p.owner) {}

  /// The number for these parameter values. O(1).
  double at(ParameterValues values) const {
    return index_ < 0 ? number_ : values[static_cast<std::size_t>(index_)];
  }
  /// The number given by the user, or the parameter's nominal value.
  double nominal() const { return number_; }
  bool is_parameter() const { return index_ >= 0; }
  int index() const { return index_; }
  const void* owner() const { return owner_; }

 private:
  double number_ = 0;
  int index_ = -1;
  const void* owner_ = nullptr;
};

}  // namespace titop
