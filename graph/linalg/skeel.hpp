#pragma once

#include <Eigen/Core>
#include <functional>

namespace titop::linalg {

/// rho(|M^-1| |M|) of a square matrix: the factor by which a solution may magnify relative errors
/// of its entries, independent of the units of rows and columns [Bauer 1963; Skeel 1979]; 0 if a
/// pivot is 0. Rows and columns of a single entry are removed first: a matrix that is triangular in
/// some order has 1. A remaining ring is computed by formula; others from above, to a few 1e-3: by
/// squaring up to 12 rows, by power iteration beyond, irreducible part by part if that does not
/// converge in 25 steps (200 at most: then a bound from above). O(n^3), less if most entries are 0.
/// `scale`, if given, may multiply rows and columns of M by powers of two before that: no radius
/// changes, but in the elimination cancelling terms must be of like size. Throws
/// std::invalid_argument beyond 128 rows.
double skeel_radius(Eigen::MatrixXd& M, const std::function<void(Eigen::MatrixXd& M)>& scale);
double skeel_radius(const Eigen::MatrixXd& M);

}  // namespace titop::linalg
