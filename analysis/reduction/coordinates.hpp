#pragma once

#include <Eigen/Core>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <vector>

/// The second-order form that the states of a passive structure have. For the library's own files.
namespace titop::detail {

/// Asymmetry of G relative to its diagonal, and relative difference of two vectors that
/// reciprocity, proportional damping or a rigid motion makes equal: rounding of an elimination.
inline constexpr double kSymmetric = 1e-7;

/// Coordinates q (each with its rate) of a structure: qdd = -G (K q + D qd) + B u with G = M^-1,
/// y = C_q q + C_v qd + direct u. The first n_elastic coordinates have stiffness, the others none:
/// of those only the rows G K and G D are known, which suffice.
struct Coordinates {
  std::vector<std::string> names;   ///< of the states q (or of the rate, if only that is a state)
  std::vector<int> nodes;           ///< of the graph
  std::vector<int> position, rate;  ///< places among the system's states; position -1: none
  Eigen::Index n_elastic = 0;
  Eigen::MatrixXd G;  ///< n_elastic x n_elastic, symmetric positive definite
  Eigen::MatrixXd K;  ///< the same size, symmetric positive definite
  Eigen::MatrixXd D;  ///< the same, semidefinite; 0 x 0: undamped
  /// Coupled coordinates with stiffness, among which are no modes of a body and no bushing with
  /// coupled axes: their G, K and D are known up to one factor, since only G K and G D are. Empty
  /// after scale_masses.
  std::vector<std::vector<int>> unscaled;
  bool diagonal = true;      ///< K is diagonal: no chain is closed, there are no coupled springs
  Eigen::MatrixXd A_loose;   ///< qdd of the loose ones from q of the elastic ones
  Eigen::MatrixXd B;         ///< n x inputs
  Eigen::MatrixXd C_q, C_v;  ///< outputs x n
  Eigen::MatrixXd direct;    ///< outputs x inputs
  /// Outputs x 2: for outputs whose motions symmetry removes (join_twins), their former sensitivity
  /// to positions and rates, as root mean square over coordinates of stiffness 1; 0 for the others.
  Eigen::MatrixXd silent;
  std::vector<std::string> blocks;  ///< that have coordinates
  Eigen::MatrixXd shares;  ///< blocks x n_elastic: share of each block in a coordinate, of sum 1
  Eigen::Index size() const { return static_cast<Eigen::Index>(names.size()); }
};

/// No passive structure: the message names the states and the reason.
class NoStructure : public Error {
 public:
  using Error::Error;
};

/// Extracts them from the model. Stiffnesses are those of the bodies' modes and of bushings with
/// coupled axes; of joints and springs those that make G symmetric, with G_ii = 1 at the first
/// coordinate of each part that is `unscaled`. Throws NoStructure (bad_value), with the names of
/// states, if there is no such form: controllers and filters in the loop, springs between
/// coordinates of different blocks, dampers on motions without stiffness. O(n^2), O(n^3) with
/// closed chains.
Coordinates coordinates(const System& system, const SystemData& data);

}  // namespace titop::detail
