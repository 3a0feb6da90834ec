#pragma once

#include <titop/analysis/certify/certify_full.hpp>
#include <titop/analysis/certify/dual_transfers.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>

namespace titop::certification {

/// Below the axis by more than rounding.
inline constexpr double kPassive = 1e-9;

/// `structure`: see analysis/certify/structure.hpp.
FullCertificate::Passivity check_passivity(const passes::DualPairs& pairs,
                                           const DualTransfers& transfers, bool structure);

}  // namespace titop::certification
