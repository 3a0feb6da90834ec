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

/// True of a complex number, and of an array of them.
bool is_complex(const pybind11::handle& object);
/// From here on arrays of complex numbers are no matrices of real ones: NumPy's copy, which every
/// conversion of an array calls, would drop imaginary parts with a warning.
void refuse_imaginary_parts();
/// The TypeError of an argument, "K of Mesh", that is no array of real numbers; `instead`: the way
/// out besides .real, if it is complex.
pybind11::type_error no_real_array(const pybind11::handle& object, const std::string& argument,
                                   const std::string& instead);

/// The array as a matrix or vector of real numbers; TypeError with the argument's name.
template <class Matrix = Eigen::MatrixXd>
Matrix real_array(const pybind11::handle& object, const std::string& argument,
                  const std::string& instead = "") {
  pybind11::detail::make_caster<Matrix> caster;
  if (!caster.load(object, true)) throw no_real_array(object, argument, instead);
  return pybind11::detail::cast_op<Matrix>(std::move(caster));
}

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

/// A number; a complex one of NumPy, whose imaginary part float() would drop, is refused.
template <>
struct type_caster<double> {
  PYBIND11_TYPE_CASTER(double, const_name("float"));
  bool load(handle source, bool convert) {
    type_caster<long double> number;  // of the same Python numbers
    if (!source || titop::python::is_complex(source) || !number.load(source, convert)) return false;
    value = static_cast<double>(static_cast<long double&>(number));
    return true;
  }
  static handle cast(double number, return_value_policy, handle) {
    return PyFloat_FromDouble(number);
  }
};

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
