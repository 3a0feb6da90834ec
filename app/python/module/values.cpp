#include "values.hpp"

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

bool has_parameter(const std::vector<Value>& values) {
  return std::any_of(values.begin(), values.end(), [](const Value& v) { return v.is_parameter(); });
}

Eigen::MatrixXd numbers(const std::vector<Value>& values, Eigen::Index n) {
  Eigen::MatrixXd result(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      result(i, j) = values[static_cast<std::size_t>(n * i + j)].nominal();
  return result;
}

}  // namespace

bool read(const py::handle& object, Value& value) {
  if (py::isinstance<Parameter>(object)) {
    value = object.cast<const Parameter&>().value;
    return true;
  }
  if (py::isinstance<py::bool_>(object) || !PyNumber_Check(object.ptr())) return false;
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
