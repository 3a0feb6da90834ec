#pragma once

#include <titop/titop.hpp>

namespace titop_bench {

/// The beam of examples/data/calculix_beam (342 modes), from P to C.
titop::FlexibleBody calculix_beam(const titop::fe::ModeOptions& modes);

/// The satellite of examples/demo.cpp with these booms; damper of the hinge [N m s/rad].
titop::Diagram satellite(const titop::FlexibleBody& boom, double damper);

}  // namespace titop_bench
