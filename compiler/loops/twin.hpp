#pragma once

#include <titop/compiler/loops/form.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::loops {

/// A sum of signals at position level: points of bodies, and other signals.
struct Twin {
  std::map<int, Eigen::MatrixXd> points;     ///< channel -> coefficient of its position
  std::map<int, Eigen::MatrixXd> rates;      ///< one-way output of a velocity -> coefficient
  std::map<int, Eigen::MatrixXd> integrals;  ///< output of an Integrator -> coefficient
  std::map<int, Eigen::MatrixXd> states;     ///< state signal -> coefficient
  std::map<int, Eigen::MatrixXd> others;     ///< any other signal: an input, a controller, a force
};

/// The twins of a lowered graph's sums: the same sums with positions in place of accelerations.
/// Gains and sums, which are equations by now, are followed through.
class Twins {
 public:
  explicit Twins(const Graph& graph);
  /// O(its terms, counted along every way through gains and sums).
  Twin of(const std::vector<Term>& terms) const;
  /// Twin of the input of a one-way port, by its equation.
  Twin of_input(int signal) const;
  bool is_integrator(int node) const;

 private:
  /// `way`: the gains and sums that are being followed through.
  void add(Twin& to, const Eigen::MatrixXd& factor, int signal, std::vector<int>& way) const;

  const Graph& g_;
  std::vector<int> equation_of_;  ///< of one-way targets and outputs of lowered nodes; -1: none
};

}  // namespace titop::loops
