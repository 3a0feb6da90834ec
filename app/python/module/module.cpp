#include "python.hpp"

namespace titop::python {

py::array_t<std::complex<double>> stacked(const std::vector<Eigen::MatrixXcd>& matrices) {
  const py::ssize_t rows = matrices.empty() ? 0 : matrices.front().rows(),
                    columns = matrices.empty() ? 0 : matrices.front().cols();
  py::array_t<std::complex<double>> result(
      {static_cast<py::ssize_t>(matrices.size()), rows, columns});
  auto entry = result.mutable_unchecked<3>();
  for (py::ssize_t k = 0; k < entry.shape(0); ++k)
    for (py::ssize_t i = 0; i < rows; ++i)
      for (py::ssize_t j = 0; j < columns; ++j)
        entry(k, i, j) = matrices[static_cast<std::size_t>(k)](i, j);
  return result;
}

py::array read_only(py::array array) {
  array.attr("setflags")("write"_a = false);
  return array;
}

}  // namespace titop::python

PYBIND11_MODULE(_titop, m) {
  using namespace titop::python;
  refuse_imaginary_parts();
  bind_errors(m);
  bind_signals(m);
  bind_diagram(m);
  bind_mounting(m);
  bind_nodes(m);
  bind_fe(m);
  bind_plates(m);
  bind_bodies(m);
  bind_lines(m);
  bind_joints(m);
  bind_hinge_line(m);
  bind_rotors(m);
  bind_models(m);
  bind_system(m);
  bind_simulation(m);
  bind_control(m);
  bind_margins(m);
  bind_reduction(m);
  bind_distributed(m);
  bind_shapes(m);
  bind_lft(m);
  bind_files(m);
}
