#pragma once

#include <string>
#include <titop/compiler/certify/dual_pairs.hpp>
#include <titop/compiler/certify_full.hpp>

namespace titop::full {

/// `no_structure`: why the system's diagram is none, or empty (compiler/certify/structure.hpp).
/// O(bodies) against O(points * forces^2).
FullCertificate::Reciprocity check_reciprocity(const System& system, const DualPairs& pairs,
                                               const DualTransfers& transfers,
                                               std::string no_structure, ParameterValues values);

}  // namespace titop::full
