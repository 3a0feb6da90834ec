#pragma once

// Closed structures by hand: every element's coordinates in terms of shared ones. Their bodies are
// in support/assembly.cpp: compiled once, not in every file here.

#include <titop/graph/linalg/eigen.hpp>

#include "../scenes/by_hand.hpp"

namespace loops_test {

using namespace scenes_test;

/// M, D, K of all parts in shared coordinates q: each part is added with its own coordinates as
/// functions of q.
struct Assembly {
  by_hand::Structure a;

  Assembly(Index n, Index inputs, Index outputs);

  /// own = Y q
  void add(const MatrixXd& M, const MatrixXd& K, const MatrixXd& Y);

  /// A beam: `start` and `end` (6 x n, in the beam's frame) move its ends, its inner nodes have
  /// coordinates of their own from `first` on.
  void beam(const by_hand::Beam& b, const MatrixXd& start, const MatrixXd& end, Index first);

  MatrixXd unit(Index first, Index count) const;
};

/// Mass matrix at P of a rigid body with centre of mass at PA, the inertia about that.
by_hand::Matrix6 mass_at_P(double mass, const Eigen::Matrix3d& inertia, const Eigen::Vector3d& PA);

/// A frame whose x axis points along `direction`.
Eigen::Matrix3d along_x(const Eigen::Vector3d& direction, const Eigen::Matrix3d& any);

/// Constraints held q = 0 by the singular values of their matrix: the motions that they allow, and
/// the multipliers of redundant constraints, which are undetermined.
struct Constraints {
  MatrixXd held;
  Eigen::JacobiSVD<MatrixXd> svd;
  Index rank = 0;
  bool clear = true;  ///< no singular value is near the limit of the rank

  explicit Constraints(const MatrixXd& rows);
  bool redundant() const { return rank < held.rows(); }
  MatrixXd motions() const { return svd.matrixV().rightCols(svd.matrixV().cols() - rank); }
  MatrixXd open() const { return svd.matrixU().rightCols(svd.matrixU().cols() - rank); }
  /// The smallest q with held q = right.
  MatrixXd motion(const MatrixXd& right) const;
  /// The smallest multipliers with held' multipliers = f.
  MatrixXcd multipliers(const MatrixXcd& f) const;
};

/// A structure under constraints, in coordinates of the motions that they leave.
by_hand::Structure constrained(const by_hand::Structure& a, const Constraints& constraints);

/// Motion under forces at s, and the constraint forces.
struct ConstrainedMotion {
  MatrixXcd q;      ///< `given` plus motions that the constraints allow
  MatrixXcd borne;  ///< force - (s^2 M + s D + K) q, which does no work on these motions
};

/// `given`: a motion that is prescribed. Beams are up to 1e9 N/m stiff: rounding of q times that
/// would be forces of 1e-8, not negligible compared with springs of 20 N/m. So the residual is
/// computed in long double, and the motions and q are refined by it.
ConstrainedMotion constrained_motion(const by_hand::Structure& a, const Constraints& constraints,
                                     Complex s, const MatrixXcd& force, const MatrixXcd& given);

/// omegas of K x = omega^2 M x, the `zeros` lowest left out.
std::vector<Complex> elastic_poles(const by_hand::Structure& a, Index zeros);

/// Poles with Im s >= 0 of any dense model.
std::vector<Complex> all_poles(const titop::System& system);

}  // namespace loops_test
