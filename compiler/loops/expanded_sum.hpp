#pragma once

#include <titop/compiler/loops/form.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::loops {

/// A sum of accelerations and other signals, by their kinds. As a sum of positions it has the same
/// coefficients.
struct ExpandedSum {
  std::map<int, Eigen::MatrixXd> points;     ///< channel -> coefficient of its acceleration
  std::map<int, Eigen::MatrixXd> rates;      ///< one-way output of a velocity -> coefficient
  std::map<int, Eigen::MatrixXd> integrals;  ///< output of an Integrator -> coefficient
  std::map<int, Eigen::MatrixXd> states;     ///< state signal -> coefficient
  std::map<int, Eigen::MatrixXd> others;     ///< any other signal: an input, a controller, a force
};

/// Expands the sums of a lowered graph: substitutes the equations of gains and sums.
class SumExpander {
 public:
  explicit SumExpander(const Graph& graph);
  /// O(its terms, counted along every way through gains and sums).
  ExpandedSum of(const std::vector<Term>& terms) const;
  /// The input of a one-way port, by its equation.
  ExpandedSum of_input(int signal) const;
  bool is_integrator(int node) const;

 private:
  /// `way`: the gains and sums that are being substituted.
  void add(ExpandedSum& to, const Eigen::MatrixXd& factor, int signal, std::vector<int>& way) const;

  const Graph& g_;
  std::vector<int> equation_of_;  ///< of one-way targets and outputs of lowered nodes; -1: none
};

}  // namespace titop::loops
