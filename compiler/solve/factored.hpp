#pragma once

#include <memory>
#include <optional>
#include <string>
#include <titop/compiler/passes/options.hpp>
#include <titop/compiler/solve/layout.hpp>
#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/solve/state_map.hpp>
#include <titop/graph/support/once.hpp>
#include <utility>
#include <vector>

/// A diagram after elimination, in numbers. For the compiler's own files only.
namespace titop::detail {

/// The data that depend on a parameter.
struct Dependents {
  std::vector<int> nodes;    ///< whose matrices change
  std::vector<int> origins;  ///< equations and outputs whose coefficients change
  std::vector<int> rows;     ///< their row groups in the joint system
  std::vector<int> loops;    ///< Stage::loops with one of these rows
};

/// Whether pivots are rounding alone: judge_weak_pivots.
struct WeakPivots {
  double least = 0;  ///< share of its terms below which a pivot counts as 0; 0: all have digits
};

struct Writing;

/// The data that do not depend on numbers: shared by all systems that `update` makes of one
/// another.
struct Skeleton {
  Stage stage;  ///< after the passes on the graph
  Options options;
  solve::JointSystem joint;                         ///< of the state space: regular
  std::optional<solve::JointSystem> before_reduce;  ///< as written, if that is singular there
  Layout layout;
  std::vector<Dependents> dependents;  ///< per parameter

  Once<std::shared_ptr<const Writing>> writing;  ///< see writing_of

  /// The equations as written: for transfers, which need no state space.
  const solve::JointSystem& as_written() const { return before_reduce ? *before_reduce : joint; }
};

/// Result of `compile` and `update` before any dense model is written: the plan, the blocks'
/// data and the factors.
struct Factored {
  std::shared_ptr<const Skeleton> skeleton;
  solve::Numbers numbers;
  StateMap states;  ///< those of the model
  std::unique_ptr<const solve::Factors<double>> factors;
  /// Scale of the equations as written, if they are others than those of the factors.
  std::shared_ptr<const solve::ColumnScale> scale_as_written;
  /// Per loop of the stage as compiled; 0 if it was not found.
  std::shared_ptr<const std::vector<double>> margins;
  /// None: not judged, of an update without a pivot weaker than before.
  std::optional<WeakPivots> weak_pivots;
  std::vector<int> changed_loops;                       ///< by updates since
  int plans_renewed = 0;                                ///< by updates since
  std::vector<double> scaled_at;                        ///< parameters when the scaling was found
  solve::Health scaled_health;                          ///< of the factors then
  std::vector<Note> notes;                              ///< of the passes with numbers, of updates
  std::vector<std::pair<std::string, double>> seconds;  ///< per pass

  Once<Eigen::MatrixX<bool>> zeros;  ///< see zero_blocks

  const Graph& graph() const { return skeleton->stage.graph; }
  const Layout& layout() const { return skeleton->layout; }
  const std::vector<std::string>& state_names() const { return states.names(layout().states); }
  /// Blocks of the transfer, units of outputs x units of inputs, that are 0 by structure, by
  /// symmetry or by rotations of frames. In 32 digits (in 50, if 32 have no digit of any block) a
  /// block that is 0 is below the largest of four limits: 1e3 times its rounding; 2^-40 of its
  /// value in double; its change if all terms change by four units of the last place of double; 1e3
  /// times the rounding of the blocks in its row and column. Found once, at pick_s, when rounding
  /// in double is first in doubt: the cost of some ten evaluations in double.
  const Eigen::MatrixX<bool>& zero_blocks() const;
  /// Sets the outputs to 0 whose zero_blocks() are 0 for all inputs. outputs x columns.
  void clear_zero_outputs(solve::RowMatrix<double>& outputs) const;
  const std::shared_ptr<const solve::ColumnScale>& scale() const {
    return scale_as_written ? scale_as_written : factors->scale();
  }
};

/// The rows of the joint system with the numbers of the state space.
solve::JointRows<double> real_rows(const Skeleton& skeleton, const solve::Numbers& numbers);

/// xdot and y for known = [x; u], column by column; x and xdot of all blocks' states.
struct RateColumns {
  solve::RowMatrix<double> xdot, y;
};

/// xdot and y through the factors: O(bodies) per column. If a pivot is below 2^-10 of its terms,
/// the unknowns are refined in double-double, for some ten times the cost. `more`: added to the
/// right-hand sides of the joint system, if it is not empty.
RateColumns rates(const Factored& data, const solve::RowMatrix<double>& known,
                  const solve::RowMatrix<double>& more = {});

}  // namespace titop::detail
