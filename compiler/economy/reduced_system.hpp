#pragma once

#include <titop/compiler/economy/scene.hpp>

namespace titop {

namespace detail {
struct ReducedData;
}

/// How far a reduced system is from the full one, over the scene's band.
struct ErrorBound {
  Eigen::MatrixXd pairs;      ///< outputs x inputs, relative as Scene says
  Eigen::MatrixXd peak;       ///< what counts as 1 for each pair, in the pair's own unit (output
                              ///< over input): |error| <= pairs * peak
  double worst = 0;           ///< the largest of `pairs`
  std::string input, output;  ///< of that pair
  double hertz = 0;           ///< where it was found [Hz]
  BoundKind kind = BoundKind::estimate;
  int samples = 0;  ///< transfers of the full factored system that it took
  /// Of balanced models: 2 x the sum of the Hankel singular values that were dropped, for the worst
  /// pair, relative as `pairs`. A theorem, not only for the band but everywhere right of the
  /// imaginary axis (up to rounding in the Gramians, and beside undamped poles whose effect is
  /// below 1e-11 of the peaks, which are left out); negative where there is none.
  double anywhere = -1;
};

/// What one step left out.
struct EconomyStep {
  std::string name;           ///< "structure", "bodies", "symmetry", "whole"; "kept", "balanced"
  int before = 0, after = 0;  ///< second-order coordinates; of "kept" and "balanced": states
  double error = 0;           ///< what it cost, relative as Scene says; 0: exact
  std::string text;           ///< in plain words
};

/// A coordinate of the reduced system.
struct KeptMode {
  double hertz = 0;       ///< of its mode [Hz]
  double damping = 0;     ///< ratio; 0 for motions without stiffness
  bool exact = false;     ///< a mode of the assembled bodies, undamped (of smaller bodies, where
                          ///< these lose modes first); else a static-like vector above the band
  bool balanced = false;  ///< neither: a pole of the balanced part
  /// Blocks that take part, with their share of its elastic energy (of balanced models, of its
  /// participation factors, as Pole::blocks), largest first, down to 5 %.
  std::vector<std::pair<std::string, double>> blocks;
};

/// Coordinates are mass-normalised, q [kg^1/2 m] or [kg^1/2 m rad]: M is I, K [rad^2/s^2], D
/// [rad/s]. M qdd + D qd + K q = B u, y = C q + C_rate qd + C_accel qdd + direct u, with M = I, D
/// symmetric semidefinite (0 if undamped), K diagonal >= 0: stable as the structure is.
struct SecondOrderModel {
  Eigen::MatrixXd M, D, K;             ///< r x r
  Eigen::MatrixXd B;                   ///< r x inputs
  Eigen::MatrixXd C, C_rate, C_accel;  ///< outputs x r
  Eigen::MatrixXd direct;              ///< outputs x inputs
  std::vector<std::string> coordinates, inputs, outputs;
  /// Outputs x inputs. O(r^3). Throws singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
};

/// xdot = A x + B u, y = C x + D u with A of 2 x 2 blocks on the diagonal: one per mode. An odd
/// real pole of a balanced model has a block with a second state that nothing moves and nobody
/// reads.
struct ModalModel {
  std::vector<Eigen::Matrix2d> A;
  Eigen::MatrixXd B, C, D;  ///< 2r x inputs, outputs x 2r, outputs x inputs
  std::vector<std::string> inputs, outputs;
  int order() const { return 2 * static_cast<int>(A.size()); }
  /// Outputs x inputs. O(r). Throws singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
};

/// A small system that answers a scene, and how well. Inputs and outputs are those of the full
/// system, in the same order: one can replace the other. Const, cheap to copy. References are good
/// while it lives; one that does not live on gives a copy, as System does.
class ReducedSystem {
 public:
  explicit ReducedSystem(std::shared_ptr<const detail::ReducedData> data)
      : data_(std::move(data)) {}

  int order() const;  ///< states of state_space()
  const std::vector<std::string>& inputs() const&;
  std::vector<std::string> inputs() const&& { return inputs(); }
  const std::vector<std::string>& outputs() const&;
  std::vector<std::string> outputs() const&& { return outputs(); }
  /// The full system with the scene's inputs and outputs.
  const System& full() const&;
  System full() const&& { return full(); }

  /// Outputs x inputs, O(order), O(order^3) where modes are coupled by damping. transfer(0), where
  /// there is one, is the full system's for modes of the whole and for balanced states whose rest
  /// is at rest; where bodies lost modes or states are truncated it is so within the bound. Throws
  /// singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;

  /// Dense; states "mode1", "mode1_rate", ...; of balanced models "kept1", ..., "balanced1", ...
  StateSpace state_space() const;
  /// The structure kept. Throws bad_value for balanced models, with what is no structure in them.
  SecondOrderModel second_order() const;
  /// 2 x 2 blocks. O(order^3) if damping couples modes. Throws singular where these are too close
  /// to defective (two of them critically damped alike, say); second_order() has them all.
  ModalModel modal() const;

  /// The question, with the accuracy that was asked for.
  const Scene& scene() const&;
  Scene scene() const&& { return scene(); }
  const ErrorBound& bound() const&;
  ErrorBound bound() const&& { return bound(); }
  /// Warnings: bodies whose own data (their highest mode) end below 1.5 times the band. No bound on
  /// the reduction sees what is not in them.
  const std::vector<Note>& notes() const&;
  std::vector<Note> notes() const&& { return notes(); }
  const std::vector<EconomyStep>& steps() const&;
  std::vector<EconomyStep> steps() const&& { return steps(); }
  const std::vector<KeptMode>& modes() const&;
  std::vector<KeptMode> modes() const&& { return modes(); }
  /// Seconds of what was done, in the order in which it was, what was done again once each time:
  /// compile, bodies, modes or split, samples, balance, reduce. Not part of to_string, which is the
  /// same on every machine.
  const std::vector<std::pair<std::string, double>>& seconds() const&;
  std::vector<std::pair<std::string, double>> seconds() const&& { return seconds(); }

 private:
  std::shared_ptr<const detail::ReducedData> data_;
};

/// What was left out, what is kept, and the bound.
std::string to_string(const ReducedSystem& system);

/// A small model that answers this question: no more than the scene needs. The diagram is compiled
/// for the scene's inputs and outputs alone; what symmetric bodies cannot show goes exactly; the
/// rest becomes modes of the band and static-like vectors of the modes above it, with the
/// second-order structure kept. The result is checked against the full factored system, and grows
/// until the bound is below the accuracy. Symmetric are bodies added from one and the same body
/// object (two that are merely equal are not compared), and not those in closed chains.
///
/// Where the scene is no passive structure (controllers and filters in the loop, dashpots without
/// springs; a note says which state), states take the place of M, D, K. Integrals, poles on the
/// axis (undamped modes have no Gramian) and poles right of it are kept whole; the well-damped rest
/// is balanced and cut, by truncation or with the states that go at rest (singular perturbation),
/// over the whole axis or behind low-passes at the band's end, whichever needs fewest states; a
/// step says which and why. The rest stays stable, which is checked; the error is checked as above,
/// and over the whole axis 2 x the sum of the dropped Hankel singular values bounds it everywhere
/// right of the axis (ErrorBound::anywhere) [Moore 1981; Enns 1984; Glover 1984].
///
/// Throws what `compile(diagram)` throws; bad_value for a scene out of range or too large, and
/// where the accuracy cannot be met, with what was reached and where; unknown_name for inputs and
/// outputs that are not there; singular where poles on the axis cannot be told from damped ones.
/// Cost: one symmetric eigenproblem, O(n^3) of the coordinates (those
/// that are left, where bodies lose modes first: Scene::whole_up_to), and some hundred transfers of
/// the full system; of balanced models a Schur form and the Gramians, O(100 n^3) of the states
/// (Scene::balance_up_to).
ReducedSystem compile(const Diagram& diagram, const Scene& scene, const Options& options = {});

/// One line of `what_if`.
struct WhatIf {
  double accuracy = 0;  ///< asked for
  int order = 0;        ///< states
  double bound = 0;     ///< reached
  /// Of one transfer of the reduced system, measured here: the least of nine runs of fifty each,
  /// since other load on the machine only adds. Figures of other builds and machines differ.
  double seconds = 0;
  ReducedSystem system;
};

/// The same question for several accuracies (Scene::accuracy is not used): one eigenproblem and one
/// nested sequence for all, so that more accuracy never gives a smaller order. Bodies lose no more
/// than the finest of them allows. Those that cannot be met are left out. In the order given.
/// Throws what `compile` throws, but for those; bad_value for accuracies out of range, all
/// together.
std::vector<WhatIf> what_if(const Diagram& diagram, const Scene& scene,
                            std::span<const double> accuracies, const Options& options = {});

}  // namespace titop
