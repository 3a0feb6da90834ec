#pragma once

#include <titop/analysis/reduction/sequence.hpp>

/// Coordinates that later ones have made needless. For the library's own files only.
namespace titop::detail {

/// Models with ever fewer coordinates than this one, each without the coordinate whose removal
/// leaves the least error on the samples, as long as that is at most `target`; the fewest last. A
/// sequence adds modes and vectors where the error is largest then, and keeps them all: some of the
/// first, which the last ones span nearly, can be spared. Empty: none can. Cost: r^2 / 2
/// projections and errors on the samples for r coordinates.
std::vector<Sequence::Choice> spared(const Sequence& sequence, const Samples& samples,
                                     Sequence::Choice choice, double target);

}  // namespace titop::detail
