#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <titop/blocks/bushing.hpp>
#include <titop/blocks/inertia.hpp>
#include <titop/blocks/position.hpp>
#include <titop/graph/value.hpp>

/// Python's numbers, parameters and sequences of them as the library's Value, Position, Inertia and
/// SixAxes.
namespace titop::python {

/// A parameter of a diagram, or a number times one; it keeps its diagram alive.
struct Parameter {
  Value value;
  std::shared_ptr<void> diagram;
};

/// False if the object is neither a number nor a parameter.
bool read(const pybind11::handle& object, Value& value);
/// A vector of 3 numbers or parameters.
bool read(const pybind11::handle& object, Position& position);
/// Three principal moments, six entries (xx, yy, zz, xy, xz, yz), or a 3 x 3 matrix.
bool read(const pybind11::handle& object, Inertia& inertia);
/// Six values, or a 6 x 6 matrix, whose entries may be parameters.
bool read(const pybind11::handle& object, SixAxes& matrix);

}  // namespace titop::python

namespace pybind11::detail {

template <>
struct type_caster<titop::Value> {
  PYBIND11_TYPE_CASTER(titop::Value, const_name("Value"));
  bool load(handle source, bool) { return titop::python::read(source, value); }
  static handle cast(const titop::Value& v, return_value_policy, handle) {
    if (!v.is_parameter()) return float_(v.nominal()).release();
    return pybind11::cast(titop::python::Parameter{v, {}}).release();
  }
};

template <>
struct type_caster<titop::Position> {
  PYBIND11_TYPE_CASTER(titop::Position, const_name("Position"));
  bool load(handle source, bool) { return titop::python::read(source, value); }
};

template <>
struct type_caster<titop::Inertia> {
  titop::Inertia value = titop::Inertia(titop::Matrix3d(titop::Matrix3d::Zero()));
  static constexpr auto name = const_name("Inertia");
  template <class T>
  using cast_op_type = movable_cast_op_type<T>;
  operator titop::Inertia*() { return &value; }
  operator titop::Inertia&() { return value; }
  operator titop::Inertia&&() && { return std::move(value); }
  bool load(handle source, bool) { return titop::python::read(source, value); }
};

template <>
struct type_caster<titop::SixAxes> {
  PYBIND11_TYPE_CASTER(titop::SixAxes, const_name("SixAxes"));
  bool load(handle source, bool) { return titop::python::read(source, value); }
};

}  // namespace pybind11::detail
