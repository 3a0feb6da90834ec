#pragma once

#include <Eigen/Core>
#include <functional>

namespace titop::linalg {

/// rho(|M^-1| |M|) of a square matrix: what solving with it can magnify relative errors of its
/// entries by, whatever the units of rows and columns [Bauer 1963; Skeel 1979]; 0 if a pivot is 0.
/// Rows and columns of a single entry leave first: a matrix that is triangular in some order has 1.
/// What is left is a ring by formula; else from above, to a few 1e-3: by squaring up to 12 rows, by
/// power iteration beyond, irreducible part by part where that does not settle in 25 steps (200 at
/// most: then a bound from above). O(n^3), less where most entries are 0. `scale`, where it is
/// given, may multiply rows and columns of M by powers of two before that: no radius changes, but
/// in the elimination what cancels must be of the size of what it cancels with. Throws
/// std::invalid_argument beyond 128 rows.
double skeel_radius(Eigen::MatrixXd& M, const std::function<void(Eigen::MatrixXd& M)>& scale);
double skeel_radius(const Eigen::MatrixXd& M);

}  // namespace titop::linalg
