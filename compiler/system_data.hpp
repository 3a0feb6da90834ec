#pragma once

#include <memory>
#include <mutex>
#include <titop/compiler/solve/joint.hpp>
#include <titop/compiler/system.hpp>

/// What a System holds, and the linear algebra that reads it; not for users.
namespace titop::detail {

using BlockMatrices = std::vector<std::shared_ptr<const Dynamics>>;

/// Where the rows and columns of the model come from.
struct Layout {
  std::vector<int> state_nodes;   ///< nodes with states, in the user's order
  std::vector<int> state_first;   ///< per node: first row of x, -1 for none
  std::vector<int> input_first;   ///< per graph input: first column of u
  std::vector<int> output_first;  ///< per graph output: first row of y
  std::vector<std::string> states, inputs, outputs;
};

struct SystemData {
  Graph written;  ///< the diagram as the user wrote it
  Stage stage;    ///< after the passes
  Options options;
  solve::Joint joint;
  BlockMatrices blocks;
  solve::Numbers<double> numbers;
  std::unique_ptr<solve::Factors<double>> factors;
  Layout layout;
  Certificate certificate;
  std::vector<std::pair<std::string, double>> seconds;  ///< per pass

  mutable std::once_flag dense_once;
  mutable StateSpace dense;
  mutable double dense_against_factors = -1;
  mutable std::vector<Note> dense_notes;
};

Layout make_layout(const Graph& graph);

/// All unknowns (joint variables) for the given states and inputs (one column each).
Eigen::MatrixXd solve_unknowns(const SystemData& data, const Eigen::MatrixXd& x,
                               const Eigen::MatrixXd& u);

/// Value of a signal (rows x columns), all signals being known through z, x and u.
Eigen::MatrixXd signal_value(const SystemData& data, int signal, const Eigen::MatrixXd& z,
                             const Eigen::MatrixXd& x, const Eigen::MatrixXd& u);

/// The dense model before `minimize`.
StateSpace write_dense(const SystemData& data);

/// Largest relative difference of xdot and y between the dense model and the factors, for one
/// random x and u (fixed seed). O(n^2).
double dense_difference(const SystemData& data, const StateSpace& dense);

/// All signals at s for one column of inputs: value(signal) by the layout of the stage's graph.
struct Point {
  std::vector<Eigen::MatrixXcd> signals;  ///< per signal of the stage's graph: size x columns
};
Point solve_at(const SystemData& data, std::complex<double> s, const Eigen::MatrixXcd& u);

/// Margins of the loops, certificate of the factors: see certify.cpp.
void certify(SystemData& data);

}  // namespace titop::detail
