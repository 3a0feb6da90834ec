#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/graph/linalg/index.hpp>

/// Points s at which a system is tried.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// Frequency of a block whose states act on themselves through others only: by the shortest such
/// round trips, of up to kLongest steps.
double by_longer_ways(const MatrixXd& A, double size) {
  constexpr int kLongest = 8;
  const MatrixXd step = A.cwiseAbs() / size;
  MatrixXd ways = step * step;
  for (int steps = 3; steps <= kLongest; ++steps) {
    ways = (ways * step).eval();
    if (const double round = ways.diagonal().maxCoeff(); round > 0)
      return size * std::pow(round, 1.0 / steps);
  }
  return 0;
}

}  // namespace

// Products of entries along round trips are independent of the units of the states, single entries
// are not: the 1 between position and rate would be taken for a frequency.
double frequency_of(const MatrixXd& A) {
  double square = 0;
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = 0; i <= j; ++i) square = std::max(square, std::abs(A(i, j) * A(j, i)));
  if (square > 0) return std::sqrt(square);
  const double size = A.cwiseAbs().maxCoeff();
  return size > 0 && std::isfinite(size) ? by_longer_ways(A, size) : 0;
}

std::complex<double> off_axis(double omega) { return {0.37 * omega, 0.93 * omega}; }

std::vector<double> frequencies_of(const MatrixXd& A) {
  // The rounding of a 0 between a position and its rate gives a product of 1e-8.
  constexpr double kRounding = 1e-6;
  const double fastest = frequency_of(A);
  if (!(fastest > 0) || !std::isfinite(fastest)) return {};
  double log_sum = 0;
  int count = 0;
  for (Index j = 0; j < A.cols(); ++j) {
    const double w = std::sqrt((A.col(j).array() * A.row(j).transpose().array()).abs().maxCoeff());
    if (w > kRounding * fastest) log_sum += std::log(w), ++count;
  }
  if (count == 0) return {fastest};
  return {std::exp(log_sum / count), fastest};
}

std::complex<double> pick_s(const Factored& d) {
  double log_sum = 0;
  int count = 0;
  std::vector<int> nodes = d.layout().state_nodes;  // by name, not as declared
  std::sort(nodes.begin(), nodes.end());
  for (const int i : nodes) {
    const double w = frequency_of(d.numbers.blocks[at(i)]->A);
    if (w > 0 && std::isfinite(w)) log_sum += std::log(w), ++count;
    if (count >= 64) break;
  }
  return off_axis(count ? std::exp(log_sum / count) : 1);
}

}  // namespace titop::detail
