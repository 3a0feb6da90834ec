#pragma once

#include <titop/compiler/certify/dual_pairs.hpp>
#include <titop/compiler/certify_full.hpp>

namespace titop::full {

/// Below the axis by more than rounding.
inline constexpr double kPassive = 1e-9;

/// `structure`: see compiler/certify/structure.hpp.
FullCertificate::Passivity check_passivity(const DualPairs& pairs, const DualTransfers& transfers,
                                           bool structure);

}  // namespace titop::full
