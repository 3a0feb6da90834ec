#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <titop/graph/error.hpp>
#include <titop/graph/value.hpp>
#include <vector>

namespace titop {

/// Quantity of a signal. A plain signal (a controller's output, an external input) takes the
/// quantity of the signal that it drives; the others must agree.
enum class Quantity : std::int8_t { plain, acceleration, velocity, position, force };

/// Default input of a channel: a child channel takes the wrench and
/// returns the acceleration (inverse dynamics), a parent channel the other way round (direct
/// dynamics). The user may drive the other one: that inverts the channel.
enum class Takes { force, accel };

/// A two-way port: a pair (acceleration, wrench) of the same size.
struct ChannelSpec {
  std::string name;  ///< "parent", "C1", ...
  int size = 6;      ///< degrees of freedom: 1 or 6
  Takes takes = Takes::force;
  std::string accel_name = "accel", force_name = "force";  ///< names of the two signals
};

/// True if a channel's force acts from its block on its surroundings: at a parent point and about
/// the axis of a joint or a rotor. At a child point, also of a bushing, it acts on the block.
bool is_outward(const ChannelSpec& channel);

/// A one-way port.
struct PortSpec {
  std::string name;
  int size = 1;
  Quantity quantity = Quantity::plain;
};

/// The ports of a block and its states by name.
///
/// Order everywhere: inputs u = input of each channel, in the order of `channels`, then `inputs`;
/// outputs y = output of each channel, in the same order, then `outputs`. By convention children
/// come first and the parent last, as in the paper: y = [xdd_C; F_P], u = [F_C; xdd_P].
struct Interface {
  std::vector<ChannelSpec> channels;
  std::vector<PortSpec> inputs, outputs;
  std::vector<std::string> states;
  /// Optional: for each state the index of its rate, -1 if it has none; empty: no state has a rate.
  /// A state with a rate is a coordinate: its row of A has one entry, 1, at its rate, and its row
  /// of B none. Closed chains need it, and the symmetric form of the whole model.
  std::vector<int> rates = {};
  std::vector<int> by_name = {};  ///< optional, for very many channels: their indices, by name

  int input_size() const;   ///< number of rows of u
  int output_size() const;  ///< number of rows of y
  /// Index of the channel called `name`, -1 if there is none. O(channels), by `by_name` O(log).
  int find_channel(std::string_view name) const;
  /// The rate of this state, -1 if none is declared.
  int rate_of(int state) const {
    return rates.empty() ? -1 : rates[static_cast<std::size_t>(state)];
  }
};

/// `Interface::rates` of n coordinates that are followed by their n rates, in the same order.
std::vector<int> rates_follow(int n);

/// A body by its N modes: etadd = W u - stiffness * eta - damping * etad (entry by entry), and
/// y = rigid u + W' etadd. States: eta, then etad.
struct Modal {
  Eigen::MatrixXd W;      ///< N x inputs
  Eigen::MatrixXd rigid;  ///< outputs x inputs
  Eigen::VectorXd stiffness, damping;
};

/// A block of a direct term, with its first row and column.
struct Gains {
  int row = 0, column = 0;
  Eigen::MatrixXd gain;
};

/// xdot = A x + B u, y = C x + D u, in the order of `Interface`. A block with a modal form may
/// provide it: the results are the same, and faster.
///
/// An algebraic block of very many ports gives D by its nonzero blocks, one per pair of ports,
/// ascending by row and then by column; D is then 0 x 0.
struct Dynamics {
  Eigen::MatrixXd A, B, C, D;
  std::shared_ptr<const Modal> modal = {};
  std::vector<Gains> sparse = {};
  /// W, rigid and stiffness of a body by modes; `modal` is the same, but empty if the damping
  /// couples the modes (Modal::damping does not count then).
  std::shared_ptr<const Modal> modes = {};

  /// The entries of `sparse` that start at this row.
  std::span<const Gains> gains_of_row(int row) const;
  /// The rows x cols block of D at (row, col): of one output port and one input port.
  Eigen::MatrixXd direct(int row, int col, int rows, int cols) const;
  /// D as one matrix.
  Eigen::MatrixXd dense_direct() const;
};

/// A parameter in a matrix tau[i] or Phi[i] of `Kinematics`, opened: x_i has `by` w more, with z =
/// `of` x_reference + `of_states` x. Empty vectors are 0.
struct OpenedMotion {
  int channel = -1;                   ///< i
  Eigen::VectorXd by;                 ///< size_i
  Eigen::RowVectorXd of;              ///< size of the reference channel
  Eigen::RowVectorXd of_states = {};  ///< n
  int pair = -1;                      ///< index in Opened::parameter
  int port = -1;                      ///< one-way input that has this w; set by the passes
};

/// Kinematics of the acceleration ports: the position of channel i is
/// `x_i = tau[i] x_reference + Phi[i] x`, x the block's state vector; Phi[i] is size_i x n.
/// Rates and accelerations likewise.
struct Kinematics {
  int reference = 0;  ///< index of the reference channel (the parent)
  std::vector<Eigen::MatrixXd> tau;
  std::vector<Eigen::MatrixXd> Phi;
  /// Stiffness of every state in the block's potential energy, sum of stiffness x^2 / 2 [J per unit
  /// squared]; 0 if it stores none. Empty: states as of modes of mass 1, stiffness = omega^2.
  /// It decides which coordinates of a closed chain depend on the others (soft ones).
  Eigen::VectorXd stiffness = {};
  std::vector<OpenedMotion> opened = {};  ///< of an opened block: `opened` terms more in x_i
};

/// A block with parameters p taken out: `dynamics` has the inputs w after those of the interface
/// and the outputs z after its outputs. With w_k = d z_k for every pair k of a parameter, it is the
/// block at the value p + d of that parameter, for any d.
struct Opened {
  Dynamics dynamics;           ///< A, B, C, D as matrices; no `modal`, no `sparse`
  std::vector<int> parameter;  ///< per pair of scalars (w_k, z_k): the index of its parameter
  std::vector<OpenedMotion> motions = {};  ///< pairs of parameters in `Kinematics`
};

/// Boolean matrix: true if this output may depend directly on this input.
using Pattern = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// A block of a diagram. Derive from it, return it from `as_block(spec)`, and `Diagram::add` takes
/// your spec (docs/architecture.md). Blocks are immutable and shared between nodes.
class Block {
 public:
  virtual ~Block() = default;
  /// Stable type name: "SpringMass", "FlexibleBody", ...
  virtual std::string_view type() const = 0;
  /// Ports and states; must not change. Checked by `compile` (`mistakes_of`).
  virtual const Interface& interface() const = 0;
  /// The matrices for these parameter values. Called several times per compile: keep them where
  /// they do not depend on parameters.
  virtual std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const = 0;
  /// The block alone at s, from its inputs to its states and outputs: X = (s - A)^-1 B and
  /// Y = C X + D. Dense by default, O(states^3); blocks with modal data do it in O(states).
  /// Throws singular if s is a pole of the block.
  struct Response {
    Eigen::MatrixXcd X, Y;
  };
  virtual Response response(std::complex<double> s, ParameterValues values) const;
  /// Declared direct feedthrough, output_size x input_size. It must not depend on the numbers: a
  /// mass of 0 or an angle of 0 is no structural zero. Default: everything.
  virtual Pattern feedthrough() const;
  /// Declared structure of the states as a whole, for any numbers: which inputs may excite them (1
  /// x input_size), which outputs may depend on them (output_size x 1). Default: all. States that
  /// are unreachable or unobservable by this structure are removed.
  virtual Pattern moved_by() const;
  virtual Pattern seen_by() const;
  /// Kinematics of the ports, if the block defines them; no chain may close through a block without
  /// kinematics. A state in Phi needs another state as its rate: see Interface::rates.
  virtual std::optional<Kinematics> kinematics(ParameterValues) const { return std::nullopt; }
  /// The values on which the matrices depend (only those that are parameters matter).
  virtual std::vector<Value> values() const { return {}; }
  /// The block at these values with the parameters of these indices taken out, each with as few
  /// pairs as it needs (RigidBody: mass 3, xx 1, xy 2, a component of PC or PA 4; SpringMass,
  /// Bushing and Gain: 1 per axis; FlexibleBody: omega 2, xi 1). None (the default): `lft` refuses
  /// a parameter of this block by name (not_rational). The result has no pairs of other parameters;
  /// its rows of B for states in `kinematics` are 0 in the columns of w, and its Phi must not
  /// depend on the parameter. `with_pairs` (graph/opened.hpp) assembles it.
  virtual std::optional<Opened> opened(ParameterValues, std::span<const int> parameters) const {
    static_cast<void>(parameters);
    return std::nullopt;
  }
  /// True if the block has no states and its rows become plain equations (a Gain, a Sum, a rigid
  /// hub of many ports).
  virtual bool is_algebraic() const { return false; }
  /// True if the vectors of its size-6 channels and size-6 plain ports are in the frame of its own
  /// node (bodies); false for controllers and scalar blocks.
  virtual bool has_frame() const { return true; }
  /// Why the direct term of this channel alone cannot be inverted, as "z1 has ..." would continue
  /// ("has parent mass 0"), and the way out. Used in the message of `improper`.
  struct Cause {
    std::string why, way_out;
  };
  virtual std::optional<Cause> why_singular(int channel, ParameterValues values) const;
};

using BlockPtr = std::shared_ptr<const Block>;

/// Stiffness of every state in the block's potential energy, 0 if it stores none: by its
/// kinematics; if they do not give it, of coordinates as of modes of mass 1, -A(rate, coordinate).
Eigen::VectorXd stiffness_of(const Block& block, const Dynamics& dynamics, ParameterValues values);

/// Mistakes of an own block's interface: two states of one name (duplicate_name), rates that are no
/// states (bad_value). Empty if there are none.
std::vector<Mistake> mistakes_of(const Interface& interface, std::string_view type);
/// Mistakes in the matrices of a user's block, as "B of this Rotor is 3 x 0, not 3 x 6": sizes
/// other than those of its interface (size), entries that are not finite (not_finite), coordinates
/// that move with more than their rate (bad_value). Empty if there are none. `compile` calls both,
/// `update` this one. O(entries).
std::vector<Mistake> mistakes_of(const Block& block, const Dynamics& dynamics);

std::string_view to_string(Quantity quantity);

}  // namespace titop
