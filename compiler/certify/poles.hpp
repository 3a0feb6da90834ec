#pragma once

#include <titop/compiler/certify_full.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Items of the full certificate (compiler/certify_full.hpp). For the compiler's own files.
namespace titop::full {

/// Poles of the dense model against the factors; `omegas`: |s| of those that are not 0, ascending.
FullCertificate::Poles check_poles(const System& system, const StateSpace& model,
                                   std::vector<double>& omegas);

}  // namespace titop::full
