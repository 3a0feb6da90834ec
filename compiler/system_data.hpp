#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/state_map.hpp>
#include <titop/compiler/system.hpp>

/// The data of a System. For the compiler's own files only.
namespace titop::detail {

/// Origin of the rows and columns of the model.
struct Layout {
  std::vector<int> state_nodes;   ///< nodes with states, as memory has them: in the graph's order
  std::vector<int> state_first;   ///< per node: first row of x, -1 for none
  std::vector<int> input_first;   ///< per graph input: first column of u
  std::vector<int> output_first;  ///< per graph output: first row of y
  std::vector<int> known_first;   ///< per signal: first row of [x; u], -1 for unknowns
  std::vector<std::string> states, inputs, outputs;  ///< states: of all blocks

  /// Number of states of all blocks, before dependent ones are eliminated (StateMap).
  Eigen::Index order() const { return static_cast<Eigen::Index>(states.size()); }
};
Layout make_layout(const Graph& graph);

/// The data that depend on a parameter.
struct Dependents {
  std::vector<int> nodes;    ///< whose matrices change
  std::vector<int> origins;  ///< equations and outputs whose coefficients change
  std::vector<int> rows;     ///< their row groups in the joint system
  std::vector<int> loops;    ///< Stage::loops with one of these rows
};
std::vector<Dependents> find_dependents(const Stage& stage, const solve::JointSystem& joint);

struct Writing;

/// The data that do not depend on numbers: shared by all systems that `update` makes of one
/// another.
struct Skeleton {
  Stage stage;  ///< after the passes
  Options options;
  solve::JointSystem joint;                         ///< of the state space: regular
  std::optional<solve::JointSystem> before_reduce;  ///< as written, if that is singular there
  Layout layout;
  std::vector<Dependents> dependents;  ///< per parameter

  mutable std::once_flag writing_once;
  mutable std::shared_ptr<const Writing> writing;  ///< see writing_of

  /// The equations as written: for transfers, which need no state space.
  const solve::JointSystem& as_written() const { return before_reduce ? *before_reduce : joint; }
};

/// Rounding error of the dense model, and its place: see Certificate::dense_error and below.
struct DenseError {
  struct Worst {
    double error = 0;
    std::complex<double> s = 0;
    int output = -1, input = -1;  ///< units of measure(); -1 if many share it
  };
  Worst beside_largest, where_small;
  std::vector<std::complex<double>> not_tried = {};  ///< s where the factors have no digit
};

/// Result of `certify`.
struct Check {
  Certificate certificate;
  std::vector<Note> notes;  ///< all of the system, its own at the end
  double lost = 0;          ///< of the outputs, by rounding, in double; 0 if it was not computed
  bool rounding_alone = false;  ///< some output is at rounding level, as far as computed
  int loop_without_digit = -1;  ///< of the stage, by its margin, or without one in double
  double least = 0;             ///< see least_pivot
};

struct SystemData {
  std::shared_ptr<const Skeleton> skeleton;
  solve::Numbers numbers;
  StateMap states;  ///< those of the model
  std::unique_ptr<const solve::Factors<double>> factors;
  /// Scale of the equations as written, if they are others than those of the factors.
  std::shared_ptr<const solve::ColumnScale> scale_as_written;
  /// Per loop of the stage as compiled; 0 if it was not found.
  std::shared_ptr<const std::vector<double>> margins;
  std::vector<int> changed_loops;                       ///< by updates since
  int plans_renewed = 0;                                ///< by updates since
  std::vector<double> scaled_at;                        ///< parameters when the scaling was found
  solve::Health scaled_health;                          ///< of the factors then
  std::vector<Note> notes;                              ///< but those of `certify`
  std::vector<std::pair<std::string, double>> seconds;  ///< per pass

  mutable std::once_flag check_once;
  mutable Check check;

  mutable std::once_flag dense_once;
  mutable StateSpace dense;
  mutable double dense_against_factors = -1;
  mutable DenseError dense_error{{-1}, {-1}};
  mutable std::vector<Note> dense_notes;
  mutable OrderVerdict dense_order;
  mutable std::atomic<bool> dense_ready = false;  ///< all of the above may be read

  mutable std::once_flag zeros_once;
  mutable Eigen::MatrixX<bool> zeros;

  const Graph& graph() const { return skeleton->stage.graph; }
  const Layout& layout() const { return skeleton->layout; }
  const std::vector<std::string>& state_names() const { return states.names(layout().states); }
  /// The certificate: computed by `compile`; of an updated system at the first call.
  const Check& checked() const;
  /// Blocks of the transfer, units of outputs x units of inputs, that are 0 by symmetry: in 32
  /// digits (or 50, if these have none) they are at rounding level, or less than 1e-15 of the row's
  /// and the column's other blocks, as a 0 after rotations of frames. Found once, at pick_s, when
  /// rounding in double is first in doubt: the cost of some ten evaluations in double.
  const Eigen::MatrixX<bool>& zero_blocks() const;
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
/// `more`: added to the right-hand sides of the joint system, if it is not empty.
RateColumns rates(const SystemData& data, const solve::RowMatrix<double>& known,
                  const solve::RowMatrix<double>& more = {});

/// About the largest frequency of a block [rad/s], by its matrix A (n x n): independent of the
/// units of its states, and in units of 1 / time. 0 if A does not determine it. O(n^2) as a rule.
double frequency_of(const Eigen::MatrixXd& A);

/// Frequencies of an assembly by its written A, in which rigid bodies between springs have no
/// frequency as blocks: the mean (in its logarithm) over the states and the largest, each of a
/// state by the product of two entries. Empty if A does not determine them. O(n^2).
std::vector<double> frequencies_of(const Eigen::MatrixXd& A);

/// An s of about this modulus, so far off the axis that no pole is near.
std::complex<double> off_axis(double omega);

/// A frequency inside the blocks' own range, off the axis. O(bodies).
std::complex<double> pick_s(const SystemData& data);

/// The transfer if there is one: none at a pole, without a digit, or if it overflows.
std::optional<Eigen::MatrixXcd> transfer_if_any(const System& system, std::complex<double> s);

/// The dense model before `minimize`, into buffers that are resized only if they do not fit.
void write_dense(const SystemData& data, StateSpace& model, int threads);

/// See Certificate::dense_against_factors. O(n^2).
double dense_difference(const SystemData& data, const StateSpace& dense);
/// Throws size and not_finite if this is no model that write_dense makes of this system.
void require_written(const SystemData& data, const StateSpace& dense);

/// A dense model and the rounding error of each of its entries.
struct Rounded {
  StateSpace model, rounding;
};
/// Rounding errors of the entries of a dense model of these sizes and names: the largest of four
/// samples by the factors. O(bodies * order).
StateSpace rounding_of(const SystemData& data, const StateSpace& dense);
/// The dense model with 0 for every entry at rounding level: below about 30 times the factors'
/// rounding of a 0 there. Couplings at rounding level become exact zeros, in any units. Unchanged
/// if that costs the transfer digits. O(bodies * order), and, if entries become 0, some transfers
/// of a dense model; for models that `minimize` judges.
Rounded without_rounding(const SystemData& data, StateSpace dense);

/// See Certificate::dense_error. O(n^2) per s; O(n^3) for up to 100 states if it is large.
DenseError dense_error(const SystemData& data, const StateSpace& dense);
/// A warning for each of the two that is too large, and if the model was not tried.
void warn_of_lost_digits(const SystemData& data, const DenseError& error, std::vector<Note>& notes);

/// Margins of these loops of the stage, others left as they are.
void find_margins(const SystemData& data, std::span<const int> loops, std::vector<double>& margins);
/// The largest of these margins, one per loop, into the certificate.
void worst_margin(const SystemData& data, std::span<const double> margins, Check& check);
/// Checks the internal forces that released closures (Stage::released) leave undetermined: throws
/// kinematic_loop for every output and controller that reads one, or notes them as minimal-norm as
/// chosen by Options::internal_forces. One solution per released direction; if these are more than
/// 32, of 32 sums of them; up to eight steps of refinement if some are read.
void judge_internal_forces(Skeleton& skeleton, const SystemData& data);

/// All passes and the certificate once more for these values of the parameters. States that
/// followed from the others still do, if that keeps the digits. `note` adds to the notes.
std::shared_ptr<const SystemData> compile_again(const Skeleton& old,
                                                const std::vector<double>& values,
                                                const std::function<void(SystemData&)>& note);

/// Potential energy x' E x / 2 of the model's states (order x order): of closed chains, whose
/// independent coordinates share springs. Empty if a block does not define its energy. O(n^3).
Eigen::MatrixXd potential_energy(const SystemData& data);

/// Replaces the dense model by the minimal one if the change of its transfer near the removed modes
/// is below 1e-8 (or ten times Options::resolution); reports it in dense_order and dense_notes.
void minimize_checked(const System& system, const SystemData& data, StateSpace& dense);

/// Certificate of the factors: see certify.cpp.
Check certify(const SystemData& data);

}  // namespace titop::detail
