#pragma once

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <string>
#include <titop/titop.hpp>
#include <utility>
#include <vector>

#include "lock.hpp"
#include "values.hpp"

/// The Python module titop: the library's functions with Python's own means. Equations are
/// assignments to attributes, errors carry the script's lines, matrices are NumPy arrays.
namespace titop::python {

namespace py = pybind11;
using namespace pybind11::literals;

/// Computations run without Python's lock, so that other threads of the interpreter go on.
using Unlocked = py::call_guard<LockReleased>;

/// The line of the script that runs now, for messages of the library. None outside of a script.
SourceLine here();

/// A vector of matrices of one size as an array (matrices x rows x columns).
py::array_t<std::complex<double>> stacked(const std::vector<Eigen::MatrixXcd>& matrices);

/// The same array, into which a script cannot write.
py::array read_only(py::array array);

/// pybind11 2.10 reads no vector of one number from a list.
using Numbers = std::vector<double>;
inline Eigen::VectorXd vector_of(const Numbers& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

/// a == b and a != b raise TypeError with this text in place of a comparison: `port == signal` as a
/// statement would be an equation that is never written.
template <class T>
void refuse_comparison(py::class_<T>& type, const char* text) {
  const auto refuse = [text](const T&, const py::object&) -> bool { throw py::type_error(text); };
  type.attr("__hash__") = py::module_::import("builtins").attr("object").attr("__hash__");
  type.def("__eq__", refuse).def("__ne__", refuse);
}

/// The value of this name; ValueError with the names there are.
template <class T>
T named(const std::string& name, const char* what,
        std::initializer_list<std::pair<const char*, T>> values) {
  std::string names;
  for (const auto& [key, value] : values) {
    if (name == key) return value;
    names += std::string(names.empty() ? "'" : ", '") + key + "'";
  }
  throw py::value_error(std::string(what) + " is one of " + names + ", not '" + name + "'");
}

/// Options of `compile` from keywords.
Options options_of(int minimize_up_to, const std::string& dump_to, double resolution,
                   const std::string& internal_forces, int exact_up_to);

/// The poles as a list with a table.
py::object pole_list(std::vector<Pole> poles);

/// Python's warning titop.CompileWarning at the script's line for each note of this kind; those
/// that `known` has are left out. With warnings as errors: their exception.
void warn(const std::vector<Note>& notes, const std::vector<Note>& known = {});

/// make(), without the lock, and then the warnings of its result.
template <class F>
auto warned(F make, const std::vector<Note>& known = {}) {
  auto result = [&] {
    const LockReleased unlocked;
    return make();
  }();
  warn(result.notes(), known);
  return result;
}

/// The object as a T (Position, Inertia, SixAxes); TypeError with `expected` and the object's type.
template <class T>
T taken(const py::handle& object, const char* expected) {
  py::detail::make_caster<T> caster;
  if (caster.load(object, true)) return py::detail::cast_op<T>(std::move(caster));
  throw py::type_error("titop: " + std::string(expected) + " is expected, not " +
                       py::repr(object).cast<std::string>());
}

void bind_errors(py::module_& m);
void bind_signals(py::module_& m);
void bind_diagram(py::module_& m);
void bind_mounting(py::module_& m);
void bind_nodes(py::module_& m);
void bind_meshes(py::module_& m);
void bind_plates(py::module_& m);
void bind_lines(py::module_& m);
void bind_bodies(py::module_& m);
void bind_joints(py::module_& m);
void bind_rotors(py::module_& m);
void bind_hinge_line(py::module_& m);
void bind_fe(py::module_& m);
void bind_models(py::module_& m);
void bind_system(py::module_& m);
void bind_simulation(py::module_& m);
void bind_control(py::module_& m);
void bind_margins(py::module_& m);
void bind_reduction(py::module_& m);
void bind_distributed(py::module_& m);
void bind_shapes(py::module_& m);
void bind_lft(py::module_& m);
void bind_files(py::module_& m);

}  // namespace titop::python
