#pragma once

#include <Eigen/Core>

namespace titop::linalg {

/// rho(|M^-1| |M|) of a square matrix: what solving with it can magnify relative errors of its
/// entries by, whatever the units of rows and columns [Bauer 1963; Skeel 1979]; 0 if a pivot is 0.
/// Rows and columns of a single entry leave first: a matrix that is triangular in some order has 1.
/// Of what is left, two rows by formula; else from above, to a few 1e-3: by squaring up to 12 rows,
/// by power iteration beyond, irreducible part by part where that does not settle in 25 steps (200
/// at most: then a bound from above). O(n^3), less where most entries are 0.
double skeel_radius(const Eigen::MatrixXd& M);

}  // namespace titop::linalg
