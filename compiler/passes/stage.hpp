#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <titop/graph/drives.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop {

/// A line of the compile log.
struct Note {
  enum class Kind {
    info,       ///< counts of a pass
    inverted,   ///< a channel that is driven on the side that its block gives by default
    removed,    ///< a part without effect on the outputs
    unchecked,  ///< accepted without a check: frames behind a nameless rotation or a matrix
    warning,    ///< lost digits, with their number; or input that is rarely intended
  };
  Kind kind = Kind::info;
  std::string pass;
  std::string text;
};

std::string_view to_string(Note::Kind kind);

/// A channel (or a one-way port) that the equations use against its block's default direction.
struct Inversion {
  int channel = -1;
  bool forced = false;  ///< by the equations; otherwise one of several choices inside a loop
};

/// A strong component of the equations: an algebraic loop, or a single signal.
struct Loop {
  std::vector<int> signals;  ///< its unknowns
  std::vector<int> rows;     ///< the rows matched to them (see `Row`)
  int unknowns = 0;          ///< scalars
};

/// One row group of the equations: an output of a block, or an equation of the user.
struct Row {
  int node = -1, output = -1;  ///< block row: y of this signal
  int equation = -1;           ///< or this equation
  int size = 0;
  bool active = true;  ///< false if `order` has found that it is not needed
};

/// Signals determined by rows: pairs (row, signal), one per scalar if a signal is split.
struct Matched {
  std::vector<std::pair<int, int>> rows;
};

/// Origin of an equation of the lowered graph, so that it can be lowered again for other
/// values of the parameters.
struct Origin {
  enum class Of {
    accel,      ///< equation `index` of the source, on an acceleration
    released,   ///< force terms of channel `index`, released: its joint is redundant
    force,      ///< all terms of the force of channel `index`
    one_way,    ///< equation `index` of the source, on a one-way port
    algebraic,  ///< the row of output signal `index` of a node that has become coefficients
    output,     ///< output `index` of the diagram
  };
  Of of = Of::accel;
  int index = -1;
  std::vector<int> parameters = {};  ///< that its coefficients depend on, ascending
  Eigen::MatrixXd times = {};        ///< rows of it that count (pass `chains`); empty: all
};

/// Integrators that `lower` adds for motions that no state determines.
struct RigidMotion {
  enum class Half { whole, linear, angular };  ///< whole: of a scalar point
  int signal = -1;                             ///< the acceleration, in Stage::graph
  Half half = Half::whole;
  bool twice = false;  ///< its output is the position, else the rate
  int node = -1;       ///< the Integrator
  auto operator<=>(const RigidMotion&) const = default;
};

/// A partly redundant closing equation: the joint is released in these directions.
struct Released {
  int equation = -1;    ///< of the released force (new), in Stage::graph
  int channel = -1;     ///< whose wrench is not determined there
  int closing = -1;     ///< the closing equation; if all of it is released, the same
  Equation whole = {};  ///< as it was: still satisfied, it follows from earlier closings
};

/// A dependent state, because of closed chains or because it integrates other states: x(node,
/// state) = sum of factor * x(node, state). The states on the right are independent, or dependent
/// ones earlier in the list.
struct Dependent {
  struct Share {
    int node = -1, state = -1;
    double factor = 0;
    double rounding = 0;  ///< of the factor
  };
  int node = -1, state = -1;
  std::vector<Share> of = {};
};

/// Pairs (w, z) of an opened parameter, an input and an output of the graph of this name: with w =
/// d z it is the graph at another value of the parameter, for d the deviation of a number, or the
/// tangent of half (or of a quarter of) the deviation of an angle.
struct OpenedPairs {
  std::string name;
  int parameter = -1;  ///< of the graph
  int size = 0;        ///< pairs of scalars
  std::string where;   ///< "hub", "wing.parent.accel": the block or equation with the parameter
};

/// A block without Block::opened, whose derivative by a parameter is that of its matrices by
/// differences (compiler/passes/open/differences.hpp).
struct ByDifferences {
  int parameter = -1;  ///< of the graph
  std::string block;
};

/// The angle of a rotation in an equation or output, with its place for messages.
struct RotationAngle {
  Value angle;
  std::string where;
};

/// Data passed from pass to pass: the graph and the results about it so far.
struct Stage {
  Graph graph;                           ///< after lower
  std::vector<double> values;            ///< parameter values
  std::shared_ptr<const Graph> source;   ///< equations as written; after lower in its order
  std::vector<Origin> origins;           ///< after lower: of every equation, then of every output
  std::shared_ptr<const Drives> drives;  ///< of source, if there are parameters
  std::vector<RigidMotion> motions;      ///< after lower
  std::vector<OpenedPairs> opened;       ///< by open_parameters; after lower: also of positions
  std::vector<ByDifferences> by_differences;  ///< by open_parameters
  std::vector<Note> notes;                    ///< the log
  std::vector<RotationAngle> angles;          ///< after check: those that `degree_notes` looks at
  std::vector<Row> rows;                      ///< after match: all rows
  Matched matched;                            ///< after match
  std::vector<Inversion> inversions;          ///< after match
  std::vector<Loop> loops;                    ///< after order: dependencies first
  bool chained = false;                       ///< after chains: some chain is closed
  bool closes = false;             ///< after chains: chains close, or Integrators may repeat states
  std::vector<Released> released;  ///< after chains
  std::vector<Dependent> dependents;  ///< after close: of chains, in turn; after solve: all
  std::vector<Dependent> before;      ///< those of the system that `update` starts from

  /// Throws std::logic_error if the stage has not begun with `as_written`.
  const Graph& written() const {
    if (!source) throw std::logic_error("a stage without a diagram: begin with as_written(graph)");
    return *source;
  }
  /// The diagram after the passes so far.
  const Graph& now() const { return origins.empty() ? written() : graph; }
};

/// The stage before the first pass, for nominal values. `lower` copies the graph, which must exist
/// until then.
Stage as_written(const Graph& graph);

}  // namespace titop
