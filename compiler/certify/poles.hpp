#pragma once

#include <titop/compiler/certify_full.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Items of the full certificate (compiler/certify_full.hpp). For the compiler's own files.
namespace titop::full {

/// Poles of the dense model against the factors, but for those that rounding may have made of 0 or
/// moved by more than 1e-8 of their size: `rounding` of each entry of A, and what eigenvalues in
/// double lose. `omegas`: |s| of those measured, ascending.
FullCertificate::Poles check_poles(const System& system, const StateSpace& model,
                                   const Eigen::MatrixXd& rounding, std::vector<double>& omegas);

}  // namespace titop::full
