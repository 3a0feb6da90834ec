#pragma once

#include <titop/analysis/certify/certify_full.hpp>
#include <titop/analysis/certify/dual_transfers.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>

namespace titop::certification {

/// A scaled eigenvalue (FullCertificate::Passivity::least) below minus this is no rounding.
inline constexpr double kPassive = 1e-9;

/// Least scaled eigenvalue of the Hermitian part of G / s over the points of `transfers`.
/// `structure`: the diagram is a structure (analysis/certify/structure.hpp). O(points forces^3).
FullCertificate::Passivity check_passivity(const passes::DualPairs& pairs,
                                           const DualTransfers& transfers, bool structure);

}  // namespace titop::certification
