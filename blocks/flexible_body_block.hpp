#pragma once

#include <titop/blocks/flexible_body.hpp>

/// The block of a FlexibleBody. For the folder's own files.
namespace titop::detail {

/// not_rational: a body of this loss factor has no state-space model.
Error no_state_space(double loss_factor);

/// The block of this spec, whose data have been checked. `like`: another block of the same data,
/// with which it shares all that does not depend on the values of modes, or none. O(N^2 + N
/// inputs^2).
BlockPtr flexible_body_block(std::shared_ptr<const FlexibleBody::Spec> spec,
                             const BlockPtr& like = nullptr);

}  // namespace titop::detail
