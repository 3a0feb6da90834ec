#pragma once

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <titop/compiler/certificate.hpp>
#include <titop/compiler/descriptor.hpp>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/modal.hpp>
#include <titop/compiler/stage.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/state_space.hpp>
#include <utility>
#include <vector>

namespace titop {

namespace detail {
struct SystemData;
}
class Excitation;
struct Full;
struct FullCertificate;
struct Simulation;
struct Trajectory;

/// Wrenches in closed chains that hold more than once, which motion does not determine.
enum class InternalForces {
  refuse,        ///< whoever reads one is refused by name
  minimal_norm,  ///< the joint that closes the chain has the smallest wrench that will do, forces
                 ///< [N] and torques [N m] alike; what reads it is marked in the log
};

/// How to compile.
struct Options {
  /// Up to this many states, `state_space()` also removes what has no effect on the transfer
  /// (pass `minimize`, O(n^3)); beyond it only what the structure shows. 0: never.
  int minimize_up_to = 100;
  /// Folder for one Graphviz file per pass (00-diagram.dot, 01-check.dot, ...); empty: none.
  std::string dump_to = {};
  /// Merge what differs by less than this (relative half-bandwidth, below 1) when minimizing; 0:
  /// only what rounding cannot tell from nothing.
  double resolution = 0;
  InternalForces internal_forces = InternalForces::refuse;
  /// Up to this many states the minimal order is found in exact arithmetic as well, where the data
  /// allow it (compiler/exact_order.hpp), and decides what `minimize` takes out, which then runs up
  /// to as many unless minimize_up_to is 0. 0: never.
  int exact_up_to = 0;
};

/// With what arithmetic a transfer is found, coarse to fine. All run through the same elimination
/// on the same plan; blocks are evaluated with it too, from data that are doubles.
enum class Precision {
  standard,  ///< double: 16 digits; one step of refinement mends what the elimination loses
  refined,   ///< factors in double, blocks and residuals in long double: refined until the outputs
             ///< settle, or refused; see System::transfer
  twofold,   ///< the same in double-double: 32 digits, on any machine
  extended,  ///< long double: 19 digits on x86
  digits50,  ///< 50 digits (Boost.Multiprecision), some hundred times slower
  as_needed  ///< double, and finer where the weakest pivot has lost more than four digits: refined
             ///< or twofold if that settles, else 50 digits; where double has no pivot at all
             ///< though s is no pole, as in wide grids, double-double or 50 digits, unless the
             ///< last place of the data decides all digits, far below all modes of a closed chain
};

/// Values of parameters by name: {{"k1", 12.0}, {"angle", 0.3}}.
using ParameterList = std::vector<std::pair<std::string, double>>;

/// A compiled diagram: the elimination plan, the factors and the blocks' data. Const, cheap to
/// copy, may be shared between threads. (Those that it works with itself are kept, asleep, for
/// later calls, and take no signals; a child of fork() goes on without them.) The dense model is
/// written from it on demand. References are good while the System lives; one that does not live on
/// gives a copy, which stays: `const StateSpace& m = compile(d).state_space();`
class System {
 public:
  explicit System(std::shared_ptr<const detail::SystemData> data) : data_(std::move(data)) {}

  int order() const;  ///< states, before `minimize`
  const std::vector<std::string>& states() const&;
  std::vector<std::string> states() const&& { return states(); }
  const std::vector<std::string>& inputs() const&;  ///< "u", or "U(1)" ... "U(6)"
  std::vector<std::string> inputs() const&& { return inputs(); }
  const std::vector<std::string>& outputs() const&;
  std::vector<std::string> outputs() const&& { return outputs(); }

  /// xdot and y of x (as states() lists them) and u (as inputs()), through the factors: O(bodies).
  /// Throws size where x or u has another size.
  struct Rates {
    Eigen::VectorXd xdot, y;
  };
  Rates apply(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const;

  /// Transfer matrix at s (outputs x inputs) through the factors of the same plan: O(bodies), full
  /// accuracy at any mass ratio unless a coarser precision is asked for. Throws singular if s is a
  /// pole of the system or of a block.
  ///
  /// `refined` and `twofold` are right to 1e-12 of each block of the transfer (a port by a port),
  /// or throw singular, even where no pole is: their factors are in double, and where these have
  /// not one digit for some unknown, or the rounding of long double costs more, they do not lead
  /// there. That is judged by estimates: of how steps of refinement shrink, in all unknowns, and of
  /// rounding. Where numbers leave the range that DoubleDouble has, `twofold` throws not_finite.
  /// The way out of all that is `as_needed`, or `digits50`. `standard` refuses only a pivot without
  /// a digit: what many pivots lose together it does not see.
  Eigen::MatrixXcd transfer(std::complex<double> s,
                            Precision precision = Precision::as_needed) const;

  /// transfer(j omega, precision) for each omega [rad/s], on `threads` threads (0: all cores);
  /// the same to the last bit whatever their number. O(bodies) per frequency. Throws what
  /// `transfer` throws: of several omega the first, such as one on an undamped pole.
  std::vector<Eigen::MatrixXcd> frequency_response(
      std::span<const double> omega, int threads = 0,
      Precision precision = Precision::as_needed) const;

  /// transfer(0), real. Throws singular if the system has a pole at 0 (a free hinge, an
  /// integrator). Where a block has a pole at 0 that the system has not (a hinge held by a spring),
  /// transfer(0) throws, and the gain is that of state_space(): its cost and its digits.
  Eigen::MatrixXd static_gain() const;

  /// The dense model. The first call writes it, O(n^2), and, up to Options::minimize_up_to states,
  /// minimizes it, O(n^3): log() says where it did not. Later calls return the same. Throws
  /// not_finite where numbers overflow.
  const StateSpace& state_space() const&;
  StateSpace state_space() const&& { return state_space(); }

  /// How sure the order of state_space() is, what was removed and at what cost; writes the model
  /// where that has not been done.
  const OrderVerdict& order_verdict() const&;
  OrderVerdict order_verdict() const&& { return order_verdict(); }

  /// The dense model before `minimize`, into a model of the caller's, whose memory is used again
  /// where it fits: what a loop over parameters wants. O(n^2), on `threads` threads (0: all cores),
  /// the same to the last bit whatever their number. What writing it down costs is for
  /// certificate(model) to say.
  void write(StateSpace& model, int threads = 0) const;

  /// The model before elimination as sparse matrices (compiler/descriptor.hpp). O(bodies).
  Descriptor descriptor() const;

  /// The same into a form of the caller's. Matrices of the same size whose entries stand where
  /// theirs did keep their memory; entries that have become 0 stay as zeros.
  void write(Descriptor& form) const;

  /// Poles of state_space() with frequency, damping and the blocks that take part. O(n^3).
  std::vector<Pole> poles() const;

  /// A new system where parameters (Diagram::param) have other values; those not named keep theirs.
  /// It shares the plan with this one, and all fronts of the elimination that do not depend on
  /// them: O(those fronts) and one pointer per block. States keep number and meaning. The scaling
  /// of these fronts is found anew where a value has moved by more than a factor of 8 since it was
  /// found, that of all where pivots have lost half their digits (Certificate::plans_renewed counts
  /// both); the numbers are then those of a fresh compile, to rounding.
  /// Pivots are judged at once; the rest of the certificate, and the warnings that come of it, are
  /// found when certificate(), notes(), log() or state_space() is first asked for: O(bodies). Among
  /// these is a loop that the new values make singular where no pivot shows it. Where a pivot keeps
  /// less than 1e-7 of its terms, and a tenth of what it kept before, all of it is found at once.
  /// `minimize` is no part of it: state_space() of the new system judges the new values, and may
  /// have another order (Options::minimize_up_to = 0 keeps all states at all values). Throws
  /// unknown_name (with the names there are), duplicate_name (one set twice), not_finite, what the
  /// blocks throw for values that make no block (bad_inertia, bad_value), improper and ill_posed.
  ///
  /// Where new values change how a closed chain moves, or bring a term in or leave one out, all
  /// passes run again, at the cost of `compile` and with its throws; the log says so, and warns if
  /// other states are kept than before. So does every update of a scene whose equations as written
  /// are singular, such as one with a point without mass (its log has notes of pass `reduce`).
  System update(const ParameterList& values) const;

  /// All parameters and their values here, in the order of their making.
  ParameterList parameters() const;

  Certificate certificate() const;
  /// The certificate with what it says of a dense model (`dense_...`) said of this one, which
  /// write() made: what writing it down costs. O(n^2), some products with A. Throws size where
  /// names or matrices are not those of a model of this system before `minimize`, not_finite where
  /// an entry is not. A model of other values is found by dense_against_factors.
  Certificate certificate(const StateSpace& written) const;
  /// What the passes did: counts, inversions, what was removed, what was not checked.
  const std::vector<Note>& notes() const&;
  std::vector<Note> notes() const&& { return notes(); }
  /// The notes as text, one per line; after state_space() also what `minimize` did.
  std::string log() const;
  /// What writing and minimizing the dense model did; empty before state_space() was asked for.
  std::vector<Note> dense_notes() const;
  /// Seconds per pass, in their order. Not part of log(), which is the same on every machine.
  const std::vector<std::pair<std::string, double>>& seconds() const&;
  std::vector<std::pair<std::string, double>> seconds() const&& { return seconds(); }
  /// The graph after the passes (for diagrams: `to_dot(system.stage())`). Its values and
  /// coefficients are those of the last compile: an `update` on the same plan leaves them.
  const Stage& stage() const&;
  Stage stage() const&& { return stage(); }

 private:
  friend FullCertificate certify(const System&, const Full&);
  friend Trajectory simulate(const System&, const Excitation&, const Simulation&);

  std::shared_ptr<const detail::SystemData> data_;
};

/// Compiles a diagram: check, lower, split, chains, match, order, close, solve, certify (see
/// compiler/pipeline.cpp, which reads like this line). Throws Error with all mistakes of the first
/// pass that finds any, bad_value for options out of their range. Cost: linear in the number of
/// bodies for trees. From the first compile on, glibc keeps up to 64 MB of freed memory in the
/// process (see compiler/memory.hpp).
System compile(const Diagram& diagram, const Options& options = {});

}  // namespace titop
