#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <titop/graph/block.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/rotation.hpp>
#include <variant>
#include <vector>

/// The representation: a plain struct of vectors and indices that every pass reads and writes.
/// A diagram is a set of linear equations between signals: each block gives the rows
/// `y = C x + D u`, each equation drives one signal (or a part of it).
namespace titop {

/// Frame of a dual vector: the index of its node, or one of these.
constexpr int kNoFrame = -1;       ///< scalars and plain signals: nothing to check
constexpr int kUnknownFrame = -2;  ///< a nameless rotation or a matrix made it: listed in the log

/// A part of a signal: all of it, or the span of orthonormal rows. Copies share their data.
class Part {
 public:
  Part() = default;  ///< all of it
  /// `rows`: m x size, orthonormal; 0 x 0 means all. `name`: for messages.
  Part(Eigen::MatrixXd rows, std::string name);

  bool whole() const { return !held_; }
  const Eigen::MatrixXd& rows() const { return held().rows; }
  /// ".linear", ".angular", ".along(0, 0, 1)"; empty of all.
  const std::string& name() const { return held().name; }

 private:
  struct NamedRows {
    Eigen::MatrixXd rows = {};
    std::string name = {};
  };
  const NamedRows& held() const;

  std::shared_ptr<const NamedRows> held_;
};

/// An input, output or state vector of a node, or an external input of the diagram.
struct Signal {
  /// Role in its block; external: in the diagram.
  enum class Role : std::int8_t { input, output, state, external };
  Role role = Role::input;
  Quantity quantity = Quantity::plain;
  int node = -1;  ///< owner, -1 for external inputs
  int spec = 0;   ///< channel index in the block's interface, or port index, or input index
  int size = 1;
  int first = 0;  ///< first row in the block's u or y
  int frame = kNoFrame;
  int channel = -1;      ///< index in Graph::channels, -1 for one-way ports
  bool active = true;    ///< false if a pass has set it aside: it is 0, or unobservable
  bool at_rest = false;  ///< set aside because it is not driven
  bool row = true;       ///< outputs: the block's row for it is in use
};

/// Number of neighbouring entries of this signal that share a unit: the three of a translation or
/// of a rotation; else 1.
inline int entries_per_unit(const Signal& s) {
  return s.size == 6 && s.quantity != Quantity::plain ? 3 : 1;
}

/// A pair of signals of one node.
struct Channel {
  int node = -1, spec = 0, size = 6;
  int accel = -1, force = -1;  ///< signals
  Takes takes = Takes::force;
};

/// A block in the diagram, with its name.
struct Node {
  std::string name = {};
  BlockPtr block = {};
  int first_signal = 0, first_channel = 0;
  int end_signal = 0;    ///< one past its last signal
  int state = -1;        ///< its state signal, -1 if it has no states
  int declared = 0;      ///< position in the user's order
  bool lowered = false;  ///< `lower` has turned its rows into equations
  SourceLine where = {};
};

/// Part of a term's coefficient. Factors act from the last to the first.
struct Matrix {
  std::shared_ptr<const Eigen::MatrixXd> value;
  std::shared_ptr<const Pattern> pattern = {};  ///< declared structure; none: nonzeros of value
};
using Factor = std::variant<Value, Rotation, Matrix, Part>;

/// sign * factors * signal.
struct Term {
  enum class Of { signal, reaction, position, rate };
  int signal = -1;  ///< for `reaction` the channel's force, for the last two its acceleration
  Of of = Of::signal;
  double sign = 1;
  std::vector<Factor> factors = {};
};

/// target (or a part of it) = sum of terms. With `accumulate`, one more term of a force.
struct Equation {
  int target = -1;
  bool accumulate = false;
  bool active = true;
  bool of_block = false;  ///< a row of a block that `lower` has turned into equations
  bool of_spec = false;   ///< written by `add`: it drives no point by itself
  Part part = {};
  std::vector<Term> terms = {};
  SourceLine where = {};
};

/// An external input and its signal.
struct Input {
  std::string name = {};
  int signal = -1, size = 1;
  int declared = 0;  ///< position in the user's order
  SourceLine where = {};
  int parameter = -1;  ///< w of this opened parameter (compiler/passes/open); its z: the output of
                       ///< the same name
};

/// An output of the diagram: the sum of its terms.
struct Output {
  std::string name = {};
  int size = 1;
  bool set = false;  ///< it has its equation
  std::vector<Term> terms = {};
  SourceLine where = {};
  int declared = 0;  ///< position in the user's order
};

/// A parameter of the diagram.
struct Parameter {
  std::string name = {};
  double value = 0;  ///< nominal
  SourceLine where = {};
};

/// A number that no call has returned before.
std::uint64_t next_graph_id();

/// A diagram as data; places in these lists are the indices above.
struct Graph {
  std::string name = {};
  std::vector<Node> nodes;
  std::vector<Channel> channels;
  std::vector<Signal> signals;
  std::vector<Equation> equations;
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::vector<Parameter> parameters;
  std::vector<Mistake> mistakes;  ///< found while the user wrote it; thrown by `check`
  /// Of the diagram, whose parameters have it: an address may be that of an earlier diagram.
  std::uint64_t id = next_graph_id();
};

/// "A1.parent.accel", "K.in", "u".
std::string name_of(const Graph& graph, int signal);
/// "A1.parent", "B.C1".
std::string channel_name(const Graph& graph, int channel);
/// See is_outward(ChannelSpec).
bool is_outward(const Graph& graph, int channel);
/// "frame A1", "no frame", "an unknown frame".
std::string frame_name(const Graph& graph, int frame);
/// The nominal values of all parameters.
std::vector<double> nominal_values(const Graph& graph);
/// The matrix of a term (rows x signal size) for these parameter values, without regard to `of`.
Eigen::MatrixXd coefficient(const Graph& graph, const Term& term, ParameterValues values);
/// Pattern of entries of that matrix that may be nonzero for any values: a rotation by 0 is still a
/// rotation.
Pattern structure(const Graph& graph, const Term& term);
/// Number of rows that the term has, -1 if its factors do not fit one another.
int rows_of(const Graph& graph, const Term& term);
/// The term as the user might write it: "-T_ba * A1.parent.force".
std::string print(const Graph& graph, const Term& term);
/// The equation as the user might write it.
std::string print(const Graph& graph, const Equation& equation);
/// Adds a node with all its signals and channels; returns its index. O(ports).
int add_node(Graph& graph, std::string name, BlockPtr block, SourceLine where);
/// Adds an external input with its signal; returns the signal.
int add_input(Graph& graph, std::string name, int size, SourceLine where = {});
/// The node's input signal whose first row in the block's u is `column`. O(log channels).
int input_signal(const Graph& graph, int node, int column);
/// One past the last signal of this node.
inline int end_signal(const Graph& graph, int node) {
  return graph.nodes[static_cast<std::size_t>(node)].end_signal;
}

/// Three-way comparison in natural order: "z2" before "z10".
int natural_compare(std::string_view a, std::string_view b);

}  // namespace titop
