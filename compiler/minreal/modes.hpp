#pragma once

#include <optional>
#include <string>
#include <titop/compiler/minreal/staircase.hpp>
#include <titop/compiler/realization/modal.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Modes of one model, with the data needed to decide which of them matter. For the compiler's own
/// files.
namespace titop::minreal {

/// Relative rounding of a row or of a cluster above which it may hide an entry that counts.
inline constexpr double kHides = 1e-11;

/// Poles that are judged as a whole: multiple ones, those at 0, ill-conditioned ones.
struct WholeCluster {
  double omega;  ///< mean |s| [rad/s]
  MinimalPart part;
  Eigen::MatrixXd V, W;  ///< n x k, k x n: A V = V A_own, W V = 1
  std::string name = {};

  int states() const { return static_cast<int>(V.cols()); }
  int unreachable() const { return static_cast<int>(part.unreachable.cols()); }
  int unseen() const { return static_cast<int>(part.unseen.cols()); }
  int leaving() const { return unreachable() + unseen(); }
};

/// Magnitudes of the modal input and output matrices.
struct ModeSet {
  Eigen::VectorXd lambda;    ///< of each mode: omega^2, or |s|
  Eigen::VectorXd omega;     ///< |s| [rad/s]
  Eigen::MatrixXd b, c;      ///< modes x nu, modes x ny: magnitudes
  std::vector<int> cluster;  ///< modes of one frequency share a number
  std::vector<int> states;   ///< of each mode; 0: the conjugate partner counts for it,
                             ///< or its cluster
  Eigen::MatrixXd distance;  ///< |lambda_i - lambda_j|
  /// e_ij: fraction of b of mode i that rounding may add to b of mode j; of c, fraction of mode j
  /// that it may add to mode i.
  Eigen::MatrixXd mixing;
  /// Rounding that all modes in `apart` cause together in the others' b and c: each of them may be
  /// of any size. Sizes of b and c, or empty: contained in `mixing`.
  Eigen::MatrixXd b_apart, c_apart;
  std::vector<std::string> apart;  ///< why it is not judged: pole at 0, ill-conditioned; or ""
  std::vector<char> needed;        ///< not judged, and yet known to be part of a minimal model
  std::vector<WholeCluster> wholes;

  Eigen::Index size() const { return lambda.size(); }
};

/// An undamped or proportionally damped model: real modes Q of yddot = -S y - Z ydot.
struct Symmetric {
  std::vector<int> q, qdot;  ///< pairs among the states
  Eigen::MatrixXd D;         ///< q = D y
  Eigen::MatrixXd D_inverse;
  ModeSet modes;
  Eigen::MatrixXd Q;  ///< in y
};
/// None if the model has no such form, by a diagonal D or, with its potential energy, by D' E D
/// = I. Modes within 2 * resolution count as equal. O(n^3).
std::optional<Symmetric> symmetric_modes(const StateSpace& model, double resolution,
                                         const Eigen::MatrixXd& energy = {});

/// Any other model: eigenvalues with left and right vectors.
struct General {
  linalg::Eigensystem e;
  ModeSet modes;
};
General general_modes(const StateSpace& model, double resolution);

}  // namespace titop::minreal
