#pragma once

#include <memory>
#include <mutex>
#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/system.hpp>

/// What stands behind a System. For the compiler's own files only.
namespace titop::detail {

/// Where the rows and columns of the model come from.
struct Layout {
  std::vector<int> state_nodes;   ///< nodes with states, in the user's order
  std::vector<int> state_first;   ///< per node: first row of x, -1 for none
  std::vector<int> input_first;   ///< per graph input: first column of u
  std::vector<int> output_first;  ///< per graph output: first row of y
  std::vector<int> known_first;   ///< per signal: first row of [x; u], -1 for unknowns
  std::vector<std::string> states, inputs, outputs;

  Eigen::Index order() const { return static_cast<Eigen::Index>(states.size()); }
};
Layout make_layout(const Graph& graph);

/// What does not depend on numbers: shared by all systems that `update` makes of one another.
struct Skeleton {
  Graph written;  ///< the diagram as the user wrote it
  Stage stage;    ///< after the passes
  Options options;
  solve::Joint joint;
  Layout layout;
};

struct SystemData {
  std::shared_ptr<const Skeleton> skeleton;
  solve::Numbers numbers;
  std::unique_ptr<const solve::Factors<double>> factors;
  Certificate certificate;
  std::vector<Note> notes;
  std::vector<std::pair<std::string, double>> seconds;  ///< per pass

  mutable std::once_flag dense_once;
  mutable StateSpace dense;
  mutable double dense_against_factors = -1;
  mutable std::vector<Note> dense_notes;

  const Graph& graph() const { return skeleton->stage.graph; }
  const Layout& layout() const { return skeleton->layout; }
};

/// The rows of the joint system with the numbers of the state space.
solve::JointRows<double> real_rows(const Skeleton& skeleton, const solve::Numbers& numbers);

/// xdot and y for known = [x; u], column by column.
struct Rates {
  solve::RowMatrix<double> xdot, y;
};
Rates rates(const SystemData& data, const solve::RowMatrix<double>& known);

/// The dense model before `minimize`, into buffers that are resized only if they do not fit.
void write_dense(const SystemData& data, StateSpace& model);

/// Largest relative difference of xdot between the dense model and the factors, for one random x
/// and u (fixed seed). O(n^2).
double dense_difference(const SystemData& data, const StateSpace& dense);

/// Margins of the loops, certificate of the factors: see certify.cpp.
void certify(SystemData& data, Stage& stage);

}  // namespace titop::detail
