#pragma once

#include <string>
#include <titop/analysis/certify/certify_full.hpp>
#include <titop/analysis/certify/dual_transfers.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>

namespace titop::certification {

/// `no_structure`: why the system's diagram is none, or empty (analysis/certify/structure.hpp).
/// O(bodies) against O(points * forces^2).
FullCertificate::Reciprocity check_reciprocity(const System& system, const passes::DualPairs& pairs,
                                               const DualTransfers& transfers,
                                               std::string no_structure, ParameterValues values);

}  // namespace titop::certification
