#pragma once

#include <titop/graph/linalg/symmetric.hpp>

namespace titop {

/// eigh for matrices graded as stiffness is, S = D G D with D diagonal over many decades and G well
/// conditioned: EVERY eigenvalue comes out to about eps * cond(G) of itself and vectors as sharp,
/// where eigh(S) gives all of them to eps * lambda_max only. Pivoted Cholesky S = L L' and the
/// singular vectors of L by Jacobi rotations [Demmel, Veselic 1992, "Jacobi's method is more
/// accurate than QR"]. Where S is not positive definite in double (rigid motions), or beyond 400
/// rows (Jacobi costs about 10 n^3 per sweep), it is eigh(S); `graded` says which it was.
struct GradedModes {
  SymmetricModes modes;
  bool graded = false;
};
GradedModes eigh_graded(const Eigen::MatrixXd& S);

}  // namespace titop
