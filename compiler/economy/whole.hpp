#pragma once

#include <titop/compiler/economy/coordinates.hpp>

/// The whole structure in its own modes. For the compiler's own files only.
namespace titop::detail {

/// The modes of an assembly, mass-normalised, and what inputs and outputs have to do with them:
///
///     q_j'' + sum_k Z_jk q_k' + lambda_j q_j = b_j u
///     y = D0 u + sum_j (ca_j q_j'' + cv_j q_j' + cq_j q_j)
///
/// Every output is written with accelerations wherever a mode has stiffness (cq_j = 0 there): D0 is
/// then its static gain without the motions that have none, and a mode that is left out keeps its
/// static part in D0.
struct Whole {
  Eigen::VectorXd lambda;  ///< n, ascending [rad^2/s^2]; the last `loose` are 0
  Eigen::Index loose = 0;  ///< motions without stiffness (free hinges, integrators): always kept
  Eigen::MatrixXd b;       ///< n x inputs
  Eigen::MatrixXd ca, cv, cq;     ///< outputs x n
  Eigen::MatrixXd D0;             ///< outputs x inputs
  Eigen::MatrixXd Z;              ///< n x n, symmetric, semidefinite; 0 x 0 where nothing is damped
  bool proportional = true;       ///< Z is diagonal, to rounding
  std::vector<char> is_position;  ///< per output
  std::vector<char> is_silent;    ///< per output: 0 by symmetry
  std::vector<std::string> blocks;  ///< that have coordinates
  Eigen::MatrixXd shares;           ///< blocks x n: of a mode's elastic energy, of sum 1

  Eigen::Index order() const { return lambda.size(); }
  Eigen::Index elastic() const { return lambda.size() - loose; }
  /// Damping coefficient of mode j by itself.
  double damping(Eigen::Index j) const { return Z.size() ? Z(j, j) : 0; }
};

/// Modes of these coordinates; of the clusters of equal frequency those that inputs and outputs
/// tell apart. D0 is what the factored system's transfer leaves at one real s beside the modes, so
/// that it also holds what they miss. Throws what `coordinates` throws. O(n^3).
Whole whole(const System& system, const Coordinates& c, std::vector<char> is_position);

/// Which outputs of a graph are positions (all their terms are), scalar by scalar, as declared.
std::vector<char> positions_read(const Graph& graph);

}  // namespace titop::detail
