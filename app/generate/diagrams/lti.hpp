#pragma once

#include <titop/graph/nodes/lti.hpp>

#include "generate/draws.hpp"

namespace titop::generate {

/// Kinds of controller matrices that elimination of s - A must handle.
enum class LtiKind {
  dense,        ///< all entries of one size
  scaled,       ///< the same in states of other units, up to 2^20 apart from 1
  permuted,     ///< one large entry in every row and column, nowhere near the diagonal
  singular,     ///< A of less than full rank, to the last bit (whole numbers)
  integrators,  ///< a chain of integrators among the states: poles at 0, up to four in a row
  unstable      ///< all poles right of the imaginary axis
};
inline constexpr LtiKind kLtiKinds[] = {LtiKind::dense,    LtiKind::scaled,      LtiKind::permuted,
                                        LtiKind::singular, LtiKind::integrators, LtiKind::unstable};

/// A controller of so many states, inputs and outputs; every other one has a direct term.
Lti random_lti(Rng& rng, LtiKind kind, Eigen::Index states, Eigen::Index inputs,
               Eigen::Index outputs);

}  // namespace titop::generate
