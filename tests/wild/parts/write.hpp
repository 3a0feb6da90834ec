#pragma once

#include <titop/graph/diagram.hpp>

#include "wild/oracle/scene.hpp"

namespace wild {

/// The scene as a user writes it: blocks, equations on their ports, inputs u1, u2, ..., outputs y1,
/// y2, ... Throws the errors of Diagram.
titop::Diagram diagram_of(const Scene& scene);

}  // namespace wild
