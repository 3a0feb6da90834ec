#pragma once

#include <complex>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::detail {

/// Rounding error of the dense model, and its place: see Certificate::dense_error and below.
struct DenseError {
  struct Worst {
    double error = 0;
    std::complex<double> s = 0;
    int output = -1, input = -1;  ///< units of measure(); -1 if many share it
  };
  Worst beside_largest, where_small;
  Worst where_used = {};  ///< as where_small, from half the slowest pole of A on
  std::vector<std::complex<double>> not_tried = {};  ///< s where the factors have no digit
};

/// See Certificate::dense_against_factors. O(n^2).
double dense_difference(const Factored& data, const StateSpace& dense);

/// Throws size and not_finite if this is no model that write_dense makes of this system.
void require_written(const Factored& data, const StateSpace& dense);

/// See Certificate::dense_error. O(n^2) per s; O(n^3) for up to 600 states if it is large.
DenseError dense_error(const Factored& data, const StateSpace& dense);

/// A warning if beside_largest or where_used is too large, and if the model was not tried.
void warn_of_lost_digits(const Factored& data, const DenseError& error, std::vector<Note>& notes);

}  // namespace titop::detail
