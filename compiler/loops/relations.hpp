#pragma once

#include <Eigen/Core>
#include <titop/graph/linalg/rounding.hpp>
#include <utility>
#include <vector>

namespace titop::loops {

/// Ranks are decided at this, absolutely, after scaling to 1: exact data give pivots of 1e-3 and
/// more or 1e-15 and less.
using linalg::kMatrixDigits;

/// Decisions by pivots between these limits are doubtful, and reported: kept ones below the first
/// (pi / 2 typed as 1.5708 tilts an axis by 4e-6), dropped ones above the second.
constexpr double kNarrow = 1e-4, kNothing = 1e-12;

/// Of the best: a pivot that is taken before the best ones are known, or kept since it was chosen
/// before. It may cost three digits.
using linalg::kThreeDigits;

/// Rows with the columns in which they have entries: M is rows x columns.
struct RowBlock {
  std::vector<int> columns = {};  ///< ascending
  Eigen::MatrixXd M = {};
};

/// Homogeneous relations R z = 0 between scalars, R as blocks of rows.
struct Relations {
  enum class Role {
    unknown,     ///< to be eliminated: a free displacement, a prescribed motion
    integral,    ///< state of an Integrator: eliminated first
    coordinate,  ///< any other coordinate
  };
  std::vector<RowBlock> blocks = {};
  std::vector<std::vector<int>> unit = {};  ///< per block and row: rows of one number share a
                                            ///< factor (three translations, three rotations)
  std::vector<Role> role = {};              ///< per column
  Eigen::VectorXd weight = {};  ///< 1 / sqrt(stiffness) if the coordinate stores energy, else 0
};

/// Scale factors of rows and columns.
struct ScaleFactors {
  std::vector<Eigen::VectorXd> row;  ///< per block
  Eigen::VectorXd column;
};
/// Equilibrates the relations, by geometry alone: the squares of every free column sum to 1, and
/// those of every unit (rows of one number: the translations or rotations of a closing equation) to
/// the sum for an even distribution of each of its free columns over the units in which it counts,
/// plus 1 for its columns that store energy. Columns that store energy are not scaled, whether
/// shapes of unit modal mass or deflections, of any stiffness: a mode that hardly moves the chain
/// (an entry of rounding, at a node of its shape) must not look like one that does. Such a scaling
/// of the counting entries exists and is unique [Sinkhorn, Knopp 1967]; sweeps approach it until
/// none changes a factor by 2 %, a hundred at most: it depends neither on units of rows and free
/// columns (they are factors themselves), nor on the frame (three rows count by their norm), nor on
/// stiffnesses. For a chain of hinges it finds the reference length of levers, from all joints
/// together; if a lever is tiny, its joint's translations do not count, and no row depends on it.
/// To be used before any elimination (afterwards noise would become 1). O(entries) per sweep; few
/// are needed, from a start that is nearly equilibrated.
ScaleFactors scale(Relations& relations);

/// z_dependent = sum of factor * z, for coordinates and integrals; in order: those on the right are
/// independent, or dependent ones earlier in the list. (In independent coordinates only, each of a
/// ladder's rungs would depend on all bays before it.)
struct Independent {
  struct Follows {
    int dependent = -1;
    std::vector<std::pair<int, double>> of = {};  ///< column, factor
    /// Of each factor: rounding of the equilibrated relations, times the inverse of their pivots.
    /// Near a singular posture it grows with 1 / distance.
    std::vector<double> rounding = {};
  };
  std::vector<Follows> follow = {};
  double weakest = 1;  ///< smallest pivot that decided on a rank
  double dropped = 0;  ///< largest that was not
  bool doubtful() const { return weakest < kNarrow || dropped > kNothing; }
};

/// Householder elimination with column pivoting, block by block: columns of one block only are
/// eliminated there, the remaining blocks merge two by two, the smallest first. Order in a block:
/// unknowns; `preferred` columns, then integrals, with pivots above 1e-3 (in the last block, of the
/// largest); all coordinates. Before the last block the pivot of a coordinate must be worth a tenth
/// of the best in the block; if other blocks have a preferred column too, rows are kept for it
/// until these have merged. Whether there is a pivot is decided on the equilibrated relations; the
/// choice is made in units of energy (eta by 1/omega): soft modes become dependent, independent of
/// their neighbours. Ties go to the first column. O(columns) if every chain has a body of its own,
/// about columns^1.5 for planar grids of chains; O(rows^2 columns) of blocks that merge without
/// eliminating any column.
Independent independent(Relations relations, const std::vector<int>& preferred = {});

}  // namespace titop::loops
