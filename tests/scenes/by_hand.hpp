#pragma once

// Structures written out as M, D, K: the references of the examples.
#include <titop/titop.hpp>

#include "../../examples/by_hand/by_hand.hpp"
#include "support/transfer_error.hpp"

namespace scenes_test {

using by_hand::Complex;
using by_hand::MatrixXcd;
using by_hand::MatrixXd;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double pi = 3.14159265358979323846;

/// Aluminium tube; the same numbers for the library and by hand.
struct Tube {
  double length, outer, inner;
  int elements;

  titop::Beam beam() const {
    return {.length = length,
            .section = titop::tube(outer, inner),
            .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
            .elements = elements};
  }
  by_hand::Beam numbers() const {
    return by_hand::tube(length, outer, inner, 70e9, 2700, elements);
  }
};

/// Points s = (0.1 + j) w: away from every pole of an undamped structure.
inline std::vector<Complex> points(std::initializer_list<double> omegas) {
  std::vector<Complex> s;
  for (const double w : omegas) s.emplace_back(0.1 * w, w);
  return s;
}

/// Transfers of any object with `transfer(s)`.
template <class Model>
std::vector<MatrixXcd> responses(const Model& model, const std::vector<Complex>& s) {
  std::vector<MatrixXcd> list;
  for (const Complex z : s) list.push_back(model.transfer(z));
  return list;
}

/// Error by blocks of three translations or rotations.
inline double error_3(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact) {
  const std::vector<Index> rows(static_cast<std::size_t>(exact[0].rows() / 3), 3);
  const std::vector<Index> cols(static_cast<std::size_t>(exact[0].cols() / 3), 3);
  return titop_test::transfer_error(a, exact, rows, cols);
}

}  // namespace scenes_test
