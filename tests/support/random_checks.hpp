#pragma once

#include <complex>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <vector>

#include "generate/diagrams/random_diagram.hpp"

/// Measurements on a random scene; the tests compare them with their tolerances.
namespace titop_test {

using titop::generate::RandomDiagram;
using titop::generate::Units;

/// Points on a line s = sigma + j omega, away from all stable poles, inside the range
/// of the scenes' frequencies.
std::vector<std::complex<double>> points(std::uint64_t seed, int count);

/// Rows and columns of a transfer matrix of the graph's own order, as the user declared them.
Eigen::MatrixXcd as_declared(const titop::Graph& graph, const Eigen::MatrixXcd& transfer);

/// Largest difference, "to 1e-x", of transfer(graph, s) before and after each pass. Runs verify and
/// the promises of support/promises.hpp after each, which throw.
struct PassError {
  double worst = 0;
  std::string pass;
};
PassError pass_error(const RandomDiagram& scene);

/// System and dense model against transfer(diagram.graph(), s); apply against the dense model; the
/// error of the dense model that its certificate states, also beside small outputs.
struct SystemError {
  double factored = 0, dense = 0, apply = 0, stated = 0;
};
SystemError system_error(const RandomDiagram& scene);

/// Minimized model against the factors.
double minimize_error(const RandomDiagram& scene);

/// "" if both models have the same entries, bit by bit, under the same names; otherwise the first
/// difference.
std::string difference_by_name(const titop::StateSpace& a, const titop::StateSpace& b);

/// Compiles in other units and brings the transfer back.
double units_error(const RandomDiagram& scene, const Units& units);

}  // namespace titop_test
