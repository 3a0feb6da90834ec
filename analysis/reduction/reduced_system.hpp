#pragma once

#include <titop/analysis/reduction/scene.hpp>

namespace titop {

namespace detail {
struct ReducedData;
}
struct PortHamiltonian;

/// Error of a reduced system against the full one, over the scene's band.
struct ErrorBound {
  Eigen::MatrixXd pairs;      ///< outputs x inputs, relative as in Scene
  Eigen::MatrixXd peak;       ///< scale of each pair, in the pair's own unit (output over input):
                              ///< |error| <= pairs * peak
  double worst = 0;           ///< the largest of `pairs`
  std::string input, output;  ///< of that pair
  double hertz = 0;           ///< where it was found [Hz]
  BoundKind kind = BoundKind::estimate;
  int samples = 0;  ///< transfers of the full factored system computed for it
  /// For balanced models: 2 x the sum of the Hankel singular values that were dropped, for the
  /// worst pair, relative as `pairs`. A proven bound, not only in the band but everywhere right of
  /// the imaginary axis (up to rounding in the Gramians, and not near omitted undamped poles, whose
  /// effect is below 1e-11 of the peaks); negative if there is none.
  double anywhere = -1;
};

/// One step of the reduction.
struct ReductionStep {
  std::string name;           ///< "structure", "bodies", "symmetry", "rotors", "whole"; "kept",
                              ///< "balanced"
  int before = 0, after = 0;  ///< second-order coordinates; of "kept" and "balanced": states
  double error = 0;           ///< its error, relative as in Scene; 0: exact
  std::string text;           ///< description
};

/// A coordinate of the reduced system.
struct KeptMode {
  double hertz = 0;       ///< of its mode [Hz]
  double damping = 0;     ///< ratio; 0 for motions without stiffness
  bool exact = false;     ///< a mode of the assembled bodies, undamped (of smaller bodies, if
                          ///< these lose modes first); else a static-like vector above the band
  bool balanced = false;  ///< a pole of the balanced part; `exact` is false
  /// Blocks that take part, with their share of its elastic energy (of balanced models, of its
  /// participation factors, as Pole::blocks), largest first, down to 5 %.
  std::vector<std::pair<std::string, double>> blocks;
};

/// Coordinates are mass-normalised, q [kg^1/2 m] or [kg^1/2 m rad]: M is I, K [rad^2/s^2], D and G
/// [rad/s]. M qdd + (D + G) qd + K q = B u, y = C q + C_rate qd + C_accel qdd + direct u, with M =
/// I, D symmetric semidefinite (0 if undamped), G = -G' of the rotors' momenta (0 without), K
/// diagonal >= 0. The energy (qd' M qd + q' K q) / 2 decreases by qd' D qd, to which G does not
/// contribute: stable if the structure is, whatever the momenta.
struct SecondOrderModel {
  Eigen::MatrixXd M, D, G, K;          ///< r x r
  Eigen::MatrixXd B;                   ///< r x inputs
  Eigen::MatrixXd C, C_rate, C_accel;  ///< outputs x r
  Eigen::MatrixXd direct;              ///< outputs x inputs
  std::vector<std::string> coordinates, inputs, outputs;
  /// Outputs x inputs. O(r^3). Throws singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
};

/// A reduced structure, ReducedSystem::second_order(), as a port-Hamiltonian system with x = [q;
/// p], p = M qd: Q = diag(K, M^-1), R = diag(0, D), G = [0; B], N = C_accel M^-1, P = direct; J has
/// -G of the momenta from p to p. H is the energy of the kept modes, elastic and kinetic [J]; of a
/// free structure without that of its rigid motion, to which they are orthogonal.
///
/// Of ReducedSystem, Q and R are semidefinite and J is skew for every order, since it is a
/// projection of the full structure: dH/dt <= (Q x)' G u, whatever modes are kept. If outputs are
/// the accelerations of the points and directions of the inputs, N = (lower half of G)', and P,
/// which has the rigid motion, is symmetric and semidefinite: Y(s) / s, from forces to rates, is
/// positive real (the structure is passive).
///
/// Throws bad_value for an output that reads a rate, or a position with damping or of a motion
/// without stiffness: y = N pdot + P u has accelerations (and undamped elastic positions) only; for
/// an M that is not positive definite. O(n^3).
PortHamiltonian port_hamiltonian(const SecondOrderModel& model);

/// xdot = A x + B u, y = C x + D u with A of 2 x 2 blocks on the diagonal: one per mode. An odd
/// real pole of a balanced model has a block with an additional unreachable and unobservable state.
struct ModalModel {
  std::vector<Eigen::Matrix2d> A;
  Eigen::MatrixXd B, C, D;  ///< 2r x inputs, outputs x 2r, outputs x inputs
  std::vector<std::string> inputs, outputs;
  int order() const { return 2 * static_cast<int>(A.size()); }
  /// Outputs x inputs. O(r). Throws singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
};

/// The reduced system of a scene, and its error bound. Inputs and outputs are those of the full
/// system, in the same order, so that it can replace the full one. Const, cheap to copy. References
/// are valid during its lifetime; a temporary returns copies, as System does.
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

  /// Outputs x inputs, O(order), O(order^3) if modes are coupled by damping. transfer(0), if
  /// there is one, is the full system's for modes of the whole and for singular perturbation of
  /// balanced states; if bodies lost modes or states are truncated it agrees within the bound.
  /// Throws singular if s is a pole.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;

  /// Dense; states "mode1", "mode1_rate", ...; of balanced models "kept1", ..., "balanced1", ...
  StateSpace state_space() const;
  /// The structure kept. Throws bad_value for balanced models, with the reason why they have none.
  SecondOrderModel second_order() const;
  /// 2 x 2 blocks. O(order^3) if damping couples modes. Throws singular if these are too close to
  /// defective (such as two critically damped modes of equal frequency, or free motions of
  /// a structure with momenta, if outputs read positions); second_order() always works.
  ModalModel modal() const;

  /// The scene, with the required accuracy.
  const Scene& scene() const&;
  Scene scene() const&& { return scene(); }
  const ErrorBound& bound() const&;
  ErrorBound bound() const&& { return bound(); }
  /// Warnings: bodies whose own data (their highest mode) end below 1.5 times the band. The bound
  /// of the reduction does not contain modes that the data lack.
  const std::vector<Note>& notes() const&;
  std::vector<Note> notes() const&& { return notes(); }
  const std::vector<ReductionStep>& steps() const&;
  std::vector<ReductionStep> steps() const&& { return steps(); }
  const std::vector<KeptMode>& modes() const&;
  std::vector<KeptMode> modes() const&& { return modes(); }
  /// Seconds of each step, in order; repeated steps once each time: compile, bodies, modes or
  /// split, samples, balance, reduce. Not part of to_string, which is the same on every machine.
  const std::vector<std::pair<std::string, double>>& seconds() const&;
  std::vector<std::pair<std::string, double>> seconds() const&& { return seconds(); }

 private:
  std::shared_ptr<const detail::ReducedData> data_;
};

/// The steps, the kept modes, and the bound.
std::string to_string(const ReducedSystem& system);

/// The reduced model of this scene. The diagram is compiled for the scene's inputs and outputs
/// alone; motions that are unreachable or unobservable by symmetry are removed exactly; the rest
/// becomes modes of the band and static-like vectors of the modes above it, with the second-order
/// structure kept. The result is checked against the full factored system, and its order is raised
/// until the bound is below the accuracy. Symmetry is detected for bodies added from one and the
/// same body object (two that are merely equal are not compared), and not for those in closed
/// chains. An Lti of uncoupled modal blocks of 2 x 2 with complex poles, [0 w; -w -2 xi w] or
/// similar to it, is a structure if inputs move each block in one direction, as forces do.
///
/// Rotors: their momenta and the friction of their bearings are projected on both sides by the same
/// modes and vectors of the structure at rest, as SecondOrderModel::G and D, at every wheel speed;
/// rates that the momenta turn into one another (of a free hub, of its rotors) are all kept. A step
/// names the points of the momenta.
///
/// If the scene is no passive structure (controllers and filters in the loop, dashpots without
/// springs; a note names the state or the force), states replace M, D, K. Integrals, poles on
/// the axis (undamped modes have no Gramian) and poles right of it are kept whole; the well-damped
/// rest is balanced and reduced, by truncation or by singular perturbation, over the whole axis or
/// with low-passes at the band's end, whichever needs the fewest states; a step contains the choice
/// and its reason. The reduced part is stable, which is checked; the error is checked as above, and
/// over the whole axis 2 x the sum of the dropped Hankel singular values bounds it everywhere right
/// of the axis (ErrorBound::anywhere) [Moore 1981; Enns 1984; Glover 1984].
///
/// Throws the errors of `compile(diagram)`; bad_value for a scene out of range or too large, and if
/// the accuracy cannot be met, with the best one and its place; unknown_name for unknown inputs and
/// outputs; singular if poles on the axis cannot be separated from damped ones. Cost: one symmetric
/// eigenproblem, O(n^3) of the coordinates (of those that remain, if bodies lose modes first:
/// Scene::whole_up_to), and some hundred transfers of the full system; of balanced models a Schur
/// form and the Gramians, O(100 n^3) of the states (Scene::balance_up_to).
ReducedSystem compile(const Diagram& diagram, const Scene& scene, const Options& options = {});

/// One line of `what_if`.
struct WhatIf {
  double accuracy = 0;  ///< required
  int order = 0;        ///< states
  double bound = 0;     ///< reached
  /// Time of one transfer of the reduced system [s], measured: the minimum of nine runs of fifty
  /// transfers each. It depends on the build and the machine.
  double seconds = 0;
  ReducedSystem system;
};

/// The same scene for several accuracies (Scene::accuracy is not used): one eigenproblem and one
/// nested sequence for all, so that more accuracy never gives a smaller order. Bodies lose only
/// modes that the smallest accuracy allows. Accuracies that cannot be met are omitted. In the order
/// given. Throws the other errors of `compile`; bad_value for accuracies out of range, all
/// together.
std::vector<WhatIf> what_if(const Diagram& diagram, const Scene& scene,
                            std::span<const double> accuracies, const Options& options = {});

}  // namespace titop
