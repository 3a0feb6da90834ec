#pragma once

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <titop/compiler/certificate/certificate.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/compiler/minreal/poles.hpp>
#include <titop/compiler/passes/options.hpp>
#include <titop/compiler/passes/stage.hpp>
#include <titop/compiler/realization/descriptor.hpp>
#include <titop/compiler/realization/modal.hpp>
#include <titop/compiler/system/pipeline.hpp>
#include <titop/compiler/system/precision.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/state_space.hpp>
#include <utility>
#include <vector>

namespace titop {

class System;
namespace detail {
struct DenseModel;
struct SystemData;
/// For the library's own files, as compiler/system/system_data.hpp.
const SystemData& data_of(const System& system);
}  // namespace detail

/// Values of parameters by name: {{"k1", 12.0}, {"angle", 0.3}}.
using ParameterList = std::vector<std::pair<std::string, double>>;

/// A compiled diagram: the elimination plan, the factors and the blocks' data. Const, cheap to
/// copy, may be shared between threads. The dense model is written from it on demand. No result
/// depends on the functions that were called before. References
/// are valid during the System's lifetime; a temporary System returns copies: `const StateSpace& m
/// = compile(d).state_space();`
class System {
 public:
  explicit System(std::shared_ptr<const detail::SystemData> data) : data_(std::move(data)) {}

  int order() const;  ///< states, before `minimize`
  /// Names of the states of `apply`, `write` and `simulate`, in their order; state_space() has
  /// fewer after `minimize`.
  const std::vector<std::string>& states() const&;
  std::vector<std::string> states() const&& { return states(); }
  const std::vector<std::string>& inputs() const&;  ///< "u", or "U(1)" ... "U(6)"
  std::vector<std::string> inputs() const&& { return inputs(); }
  const std::vector<std::string>& outputs() const&;
  std::vector<std::string> outputs() const&& { return outputs(); }
  /// Column of the transfer, and entry of u, of this scalar input: `system.input("ref(3)")`; row of
  /// the transfer, and entry of y, of this scalar output. Throw unknown_name with the first of
  /// the valid names. O(names).
  int input(const std::string& name) const;
  int output(const std::string& name) const;

  /// xdot and y of x (as states() lists them) and u (as inputs()), in SI units and the frames of
  /// the ports, through the factors: O(bodies). Throws size if x or u has another size.
  struct Rates {
    Eigen::VectorXd xdot, y;
  };
  Rates apply(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const;

  /// Transfer matrix at s (outputs x inputs) through the factors of the same plan: O(bodies), full
  /// accuracy at any mass ratio with the default precision. Throws singular if s is a pole of the
  /// system or of a block.
  ///
  /// `refined` and `twofold` are accurate to 1e-12 of each block of the transfer (a port by a
  /// port), or throw singular, also without a pole: their factors are in double, and if these have
  /// no digit for some unknown, or if the rounding of long double is too large, refinement fails.
  /// Both are estimates: the convergence of the refinement steps in all unknowns, and the rounding.
  /// If numbers exceed the range of DoubleDouble, `twofold` throws not_finite. In all these cases
  /// use `as_needed` or `digits50`.
  ///
  /// In every precision the final unknowns must solve the equations to the rounding of their terms
  /// (of double for `refined` and `twofold`), as the exact solution for data changed in their last
  /// digits does (RefinedSolution::holds in compiler/solve). Otherwise `as_needed` takes finer
  /// arithmetic, and the others throw singular. `standard` is so the transfer of a system within
  /// rounding of this one: it loses the digits that the scene's conditioning costs, `as_needed`
  /// does not.
  Eigen::MatrixXcd transfer(std::complex<double> s,
                            Precision precision = Precision::as_needed) const;

  /// transfer(j omega, precision) for each omega [rad/s], on `threads` threads (0: all cores); the
  /// same to the last bit for any number of threads. O(bodies) per frequency. Throws the errors of
  /// `transfer`: of several that of the first omega, such as one on an undamped pole.
  std::vector<Eigen::MatrixXcd> frequency_response(
      std::span<const double> omega, int threads = 0,
      Precision precision = Precision::as_needed) const;

  /// transfer(0), real. Throws singular if the system has a pole at 0 (a free hinge, an
  /// integrator). If a block has a pole at 0 that the system has not (a hinge held by a spring),
  /// transfer(0) throws, and the gain is computed from state_space(), at its cost and accuracy.
  Eigen::MatrixXd static_gain() const;

  /// The dense model. The first call writes it, O(n^2), and, up to Options::minimize_up_to states,
  /// minimizes it, O(n^3); otherwise dense_notes() reports that it did not. Later calls return the
  /// same. Throws not_finite if numbers overflow.
  const StateSpace& state_space() const&;
  StateSpace state_space() const&& { return state_space(); }

  /// Reliability of the order of state_space(), the removed states and the error of removing them;
  /// writes the model if that has not been done.
  const OrderVerdict& order_verdict() const&;
  OrderVerdict order_verdict() const&& { return order_verdict(); }

  /// The dense model before `minimize`, into the caller's model, whose memory is reused if it fits:
  /// for loops over parameters. O(n^2), on `threads` threads (0: all cores), the same to the last
  /// bit for any number of threads. certificate(model) returns its rounding error.
  void write(StateSpace& model, int threads = 0) const;

  /// The model before elimination as sparse matrices (compiler/realization/descriptor.hpp).
  /// O(bodies).
  Descriptor descriptor() const;

  /// The same into an existing form. Matrices of the same size and pattern keep their memory;
  /// entries that have become 0 stay as zeros.
  void write(Descriptor& form) const;

  /// Poles of state_space() with frequency, damping and the blocks that take part
  /// (compiler/minreal/poles.hpp). O(n^3).
  std::vector<Pole> poles() const;

  /// A new system with other values of parameters (Diagram::param); those not named keep theirs. It
  /// shares the plan with this one, and all fronts of the elimination that do not depend on them:
  /// O(those fronts) and one pointer per block. States keep number and meaning, except as below.
  /// The scaling of these fronts is recomputed if a value has changed by more than a factor of 8
  /// since the last time, that of all fronts if pivots have lost half their digits
  /// (Certificate::plans_renewed counts both); the numbers are then those of a fresh compile, to
  /// rounding. Pivots are checked at once; the rest of the certificate, and its warnings, are
  /// computed at the first call of certificate(), notes(), log() or state_space(): O(bodies). They
  /// include loops that the new values make singular without a small pivot. If a pivot is less than
  /// 1e-7 of its terms, and a tenth of its former ratio, the margins are computed and the pivots
  /// judged at once. `minimize` is not included: state_space() of the new system runs it for the
  /// new values, and may have another order (Options::minimize_up_to = 0 keeps all states at all
  /// values). Throws unknown_name (with the valid names), duplicate_name (one set twice),
  /// not_finite, the errors of blocks for invalid values (bad_inertia, bad_value), improper and
  /// ill_posed. Angles of more than a turn are warned of, as by `compile`.
  ///
  /// If new values change how a closed chain moves, or add or remove a term, all passes run again,
  /// with the cost and the errors of `compile`; the log reports it, and warns if other states are
  /// kept than before. The same is true of every update of a scene whose equations as written are
  /// singular, such as one with a point without mass (its log has notes of pass `reduce`).
  System update(const ParameterList& values) const;

  /// All parameters and their values here, in the order of creation.
  ParameterList parameters() const;

  /// The checks of the factored system; its `dense_...` fields are not evaluated. O(bodies) at the
  /// first call after `update`.
  Certificate certificate() const;
  /// The same with the `dense_...` fields of the model before `minimize` from which state_space()
  /// is made; makes it if that has not been done, at the cost and with the errors of state_space().
  Certificate dense_certificate() const;
  /// The certificate whose `dense_...` fields refer to this model, made by write(): its rounding
  /// error. O(n^2), some products with A. Throws size if names or matrices are not those of a model
  /// of this system before `minimize`, not_finite if an entry is not. A model of other values has a
  /// large dense_against_factors.
  Certificate certificate(const StateSpace& written) const;
  /// Results of the passes of `compile` and of `update`: counts, inversions, removed and unchecked
  /// parts.
  const std::vector<Note>& notes() const&;
  std::vector<Note> notes() const&& { return notes(); }
  /// The name, the numbers of states, inputs and outputs, and the notes as text, one per line.
  std::string log() const;
  /// Notes on writing and minimizing the model of state_space(), and, if that has been minimized,
  /// on modes that are damped unlike their bodies (Pole::unlike_bodies). The first call makes the
  /// model, at the cost of state_space() and poles() and with the errors of state_space();
  /// dense_log() does the same. dense_seconds() makes the model without its poles.
  const std::vector<Note>& dense_notes() const&;
  std::vector<Note> dense_notes() const&& { return dense_notes(); }
  /// The same as text, one per line.
  std::string dense_log() const;
  /// Seconds per pass of `compile`, in their order: of those of compiler_passes() that have run.
  /// Not part of log(), which is the same on every machine.
  const std::vector<std::pair<std::string, double>>& seconds() const&;
  std::vector<std::pair<std::string, double>> seconds() const&& { return seconds(); }
  /// The same of the passes that have made state_space().
  const std::vector<std::pair<std::string, double>>& dense_seconds() const&;
  std::vector<std::pair<std::string, double>> dense_seconds() const&& { return dense_seconds(); }
  /// The graph after the passes (for diagrams: `to_dot(system.stage())`). Its values and
  /// coefficients are those of the last compile: an `update` on the same plan does not change them.
  const Stage& stage() const&;
  Stage stage() const&& { return stage(); }

 private:
  const detail::DenseModel& dense() const;

  friend const detail::SystemData& detail::data_of(const System&);

  std::shared_ptr<const detail::SystemData> data_;
};

/// Compiles a diagram by the passes of compiler_passes() (docs/architecture.md). Throws Error with
/// all mistakes of the first pass that finds any, bad_value for options out of their range. Cost:
/// linear in the number of bodies for trees.
System compile(const Diagram& diagram, const Options& options = {});

}  // namespace titop
