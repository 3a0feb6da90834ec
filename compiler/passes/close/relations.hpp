#pragma once

#include <Eigen/Core>
#include <vector>

namespace titop::passes::closing {

/// Ranks are decided at this, absolutely, after scaling to 1: exact data give pivots of 1e-3 and
/// more or 1e-15 and less.
constexpr double kRankTolerance = 1e-9;

/// Decisions by pivots that neither leave are doubtful, and reported: kept ones below the first
/// (pi / 2 typed as 1.5708 tilts an axis by 4e-6), dropped ones above the second.
constexpr double kNarrow = 1e-4, kNothing = 1e-12;

/// Homogeneous relations R z = 0 between scalars.
struct Relations {
  enum class Role {
    unknown,     ///< to be eliminated: a free displacement, a prescribed motion
    integral,    ///< state of an Integrator: leaves first
    coordinate,  ///< any other coordinate
  };
  Eigen::MatrixXd R = {};
  std::vector<int> unit = {};  ///< rows of one number share a factor: three translations, rotations
  std::vector<Role> role = {};  ///< per column
  Eigen::VectorXd weight = {};  ///< 1 / sqrt(stiffness) where the coordinate stores energy, else 0
};

/// z_dependent = T z_independent, for coordinates and integrals.
struct Independent {
  std::vector<int> dependent, independent;
  Eigen::MatrixXd T;
  double weakest = 1;  ///< smallest pivot that was taken
  double dropped = 0;  ///< largest that was not
  bool doubtful() const { return weakest < kNarrow || dropped > kNothing; }
};

/// Scales the relations so that units do not matter: columns in units of energy (eta by 1/omega:
/// soft modes become dependent), one factor for the translations or rotations of a closing
/// equation, taken before any elimination (afterwards noise would become 1), all other columns to
/// largest entry 1. Returns by what rows and columns were multiplied.
struct Factors {
  Eigen::VectorXd row, column;
};
Factors scale(Relations& relations);

/// Householder elimination with column pivoting: unknowns first, then `preferred` columns and
/// integrals while their pivots keep 1e-3, then all coordinates. Ties go to the first column.
/// O(rows^2 columns).
Independent independent(Relations relations, const std::vector<int>& preferred = {});

/// Directions among these rows (k x rows, orthonormal) in which they follow from the rows met
/// before. All rows are scaled.
struct Redundant {
  Eigen::MatrixXd directions;
  double weakest = 1;  ///< smallest singular value that counts
  double dropped = 0;  ///< largest that does not
  bool doubtful() const { return weakest < kNarrow || dropped > kNothing; }
};
/// `known`: orthonormal columns spanning the rows met before; grows by what is new.
Redundant redundant(const Eigen::MatrixXd& rows, Eigen::MatrixXd& known);

}  // namespace titop::passes::closing
