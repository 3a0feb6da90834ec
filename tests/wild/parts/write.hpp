#pragma once

#include <titop/graph/diagram.hpp>

#include "wild/oracle/scene.hpp"

namespace wild {

/// The scene as a user writes it: blocks, equations on their ports, inputs u1, u2, ..., outputs y1,
/// y2, ... Throws what writing throws.
titop::Diagram diagram_of(const Scene& scene);

}  // namespace wild
