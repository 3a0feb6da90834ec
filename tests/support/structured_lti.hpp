#pragma once

#include <cstdint>
#include <titop/graph/nodes/lti.hpp>

namespace titop_test {

/// Matrices whose entries are short fractions in powers of two, and their minimal order.
struct StructuredLti {
  titop::Lti lti;
  int order = 0;
};

/// Two to five small systems of one input and one output (chains of integrators, lags, oscillators
/// with and without damping, multiple poles), some of them equal, coupled in rows and loops, with
/// one or two inputs and outputs. `units`: states in units of 2^-20 to 2^20. The order is the rank
/// of [C; C A; ...] [B, A B, ...] modulo the prime 2^61 - 1, by code of its own.
StructuredLti structured_lti(std::uint64_t seed, bool units);

}  // namespace titop_test
