#pragma once

#include <titop/compiler/realization/descriptor.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/state_space.hpp>

namespace titop::detail {

/// The dense model before `minimize`, into buffers that are resized only if they do not fit.
void write_dense(const Factored& data, StateSpace& model, int threads);

/// The model before elimination, into a form of the caller's: see System::write.
void write_descriptor(const Factored& data, Descriptor& form);

}  // namespace titop::detail
