#pragma once

#include <Eigen/Core>
#include <titop/graph/state_space.hpp>

namespace titop {

/// Transmission zeros of a model [rad/s]: the finite s at which its system matrix [A - s, B; C, D]
/// has less than its normal rank. A minimal model has at these s an input u e^(st) without output.
/// Unreachable and unobservable modes of a model that is not minimal are among them (invariant
/// zeros); System::state_space() is minimal up to Options::minimize_up_to states. Conjugate pairs
/// stand together.
///
/// Orthogonal reduction to a model with an invertible direct term [Emami-Naeini, Van Dooren,
/// Automatica 18 (1982)], whose zeros are the eigenvalues of A - B D^-1 C. Ranks count singular
/// values above (n + inputs + outputs) 2^-52 of the largest of the model, of B and C in units in
/// which they are as large as the scaled A: an input and output related by a direct term or product
/// C A^k B that is smaller than that has more zeros, far away. Throws size for matrices that do not
/// fit each other, not_finite for entries that are not finite. O(n^3) to O(n^4) (long chains of
/// integrators).
Eigen::VectorXcd transmission_zeros(const StateSpace& model);

}  // namespace titop
