#include "values.hpp"

#include <titop/graph/linalg/rounding.hpp>

#include "python.hpp"

namespace titop::python {
namespace {

/// The items of a list, tuple or array; empty of anything else.
std::vector<py::object> items(const py::handle& object) {
  std::vector<py::object> result;
  if (!py::isinstance<py::sequence>(object) && !py::isinstance<py::array>(object)) return result;
  if (py::isinstance<py::str>(object)) return result;
  for (const py::handle& item : object) result.push_back(py::reinterpret_borrow<py::object>(item));
  return result;
}

bool read_all(const std::vector<py::object>& objects, std::vector<Value>& values) {
  values.resize(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (!read(objects[i], values[i])) return false;
  return true;
}

/// The entries of a matrix of n rows and n columns, row by row.
bool read_matrix(const std::vector<py::object>& rows, std::size_t n, std::vector<Value>& values) {
  values.clear();
  if (rows.size() != n) return false;
  for (const py::object& row : rows) {
    std::vector<Value> of_row;
    if (!read_all(items(row), of_row) || of_row.size() != n) return false;
    values.insert(values.end(), of_row.begin(), of_row.end());
  }
  return true;
}

/// The kind of the numbers of a NumPy object, 'c' of complex ones; "" of other objects.
std::string kind_of(const py::handle& object) {
  if (!py::hasattr(object, "dtype")) return {};
  return py::str(py::getattr(object.attr("dtype"), "kind", py::str()));
}

/// True of a complex number or a truth value, also of NumPy, which float() would accept or warn of.
bool is_no_real(const py::handle& object) {
  return py::isinstance<py::bool_>(object) || is_complex(object) || kind_of(object) == "b";
}

/// NumPy's own copy of one array into another.
int (*copy_into)(PyObject* to, PyObject* from) = nullptr;

int copy_real_into(PyObject* to, PyObject* from) {
  if (!is_complex(from) || is_complex(to)) return copy_into(to, from);
  PyErr_SetString(PyExc_TypeError, "titop: an array of real numbers is expected");
  return -1;
}

/// The same number, or the same multiple of the same parameter.
bool same(const Value& a, const Value& b) {
  return a.nominal() == b.nominal() && a.index() == b.index() && a.scale() == b.scale();
}

bool has_parameter(const std::vector<Value>& values) {
  return std::any_of(values.begin(), values.end(), [](const Value& v) { return v.is_parameter(); });
}

/// Refuses a matrix with parameters whose entries (i, j) and (j, i) differ: the library takes one
/// of them for both. n rows.
void require_symmetric(const std::vector<Value>& values, std::size_t n, Code code,
                       const char* what) {
  if (!has_parameter(values)) return;
  double size = 0;
  for (const Value& v : values) size = std::max(size, std::abs(v.nominal()));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const Value &upper = values[n * i + j], &lower = values[n * j + i];
      const bool differ =
          upper.is_parameter() || lower.is_parameter()
              ? !same(upper, lower)
              : std::abs(upper.nominal() - lower.nominal()) > linalg::kMatrixDigits * size;
      if (differ) {
        const std::string row = std::to_string(i + 1), column = std::to_string(j + 1);
        throw Error(code,
                    std::string(what) + " is not symmetric: its entries (" + row + ", " + column +
                        ") and (" + column + ", " + row + ") differ",
                    "write the same number or the same parameter at both");
      }
    }
}

Eigen::MatrixXd numbers(const std::vector<Value>& values, Eigen::Index n) {
  Eigen::MatrixXd result(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      result(i, j) = values[static_cast<std::size_t>(n * i + j)].nominal();
  return result;
}

}  // namespace

bool is_complex(const py::handle& object) {
  if (PyFloat_Check(object.ptr()) || PyLong_Check(object.ptr())) return false;
  return PyComplex_Check(object.ptr()) || kind_of(object) == "c";
}

void refuse_imaginary_parts() {
  auto& numpy = py::detail::npy_api::get();
  if (copy_into) return;
  copy_into = numpy.PyArray_CopyInto_;
  numpy.PyArray_CopyInto_ = copy_real_into;
}

py::type_error no_real_array(const py::handle& object, const std::string& argument,
                             const std::string& instead) {
  std::string text = "titop: " + argument + ": an array of real numbers is expected, not " +
                     py::repr(object).cast<std::string>();
  if (const py::array array = py::array::ensure(object); array && is_complex(array))
    text += ". Write .real of it to leave the imaginary part out" + instead;
  return py::type_error(text);
}

bool read(const py::handle& object, Value& value) {
  if (py::isinstance<Parameter>(object)) {
    value = object.cast<const Parameter&>().value;
    return true;
  }
  if (!PyNumber_Check(object.ptr()) || is_no_real(object)) return false;
  const double number = PyFloat_AsDouble(object.ptr());
  if (PyErr_Occurred()) {
    PyErr_Clear();
    return false;
  }
  value = number;
  return true;
}

bool read(const py::handle& object, Position& position) {
  std::vector<Value> v;
  if (!read_all(items(object), v) || v.size() != 3) return false;
  if (has_parameter(v))
    position = Position(v[0], v[1], v[2]);
  else
    position = Vector3d(v[0].nominal(), v[1].nominal(), v[2].nominal());
  return true;
}

bool read(const py::handle& object, Inertia& inertia) {
  const std::vector<py::object> list = items(object);
  std::vector<Value> v;
  if (read_matrix(list, 3, v)) {
    require_symmetric(v, 3, Code::bad_inertia, "the inertia");
    if (has_parameter(v))
      inertia = Inertia(v[0], v[4], v[8], v[1], v[2], v[5]);
    else
      inertia = Inertia(numbers(v, 3));
    return true;
  }
  if (!read_all(list, v) || (v.size() != 3 && v.size() != 6)) return false;
  inertia = v.size() == 3 ? Inertia(v[0], v[1], v[2]) : Inertia(v[0], v[1], v[2], v[3], v[4], v[5]);
  return true;
}

bool read(const py::handle& object, SixAxes& matrix) {
  const std::vector<py::object> list = items(object);
  std::vector<Value> v;
  if (read_matrix(list, 6, v)) {
    require_symmetric(v, 6, Code::bad_value, "the matrix of six axes");
    matrix = SixAxes(numbers(v, 6));
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j)
        if (const Value& entry = v[static_cast<std::size_t>(6 * i + j)]; entry.is_parameter())
          matrix = matrix.with(i + 1, j + 1, entry);
    return true;
  }
  if (!read_all(list, v) || v.size() != 6) return false;
  matrix = SixAxes(v[0], v[1], v[2], v[3], v[4], v[5]);
  return true;
}

}  // namespace titop::python
