#pragma once

#include <titop/blocks/diagram_file/blocks.hpp>

namespace titop::diagram_file {

/// The fields "omega", "xi", "L_P" and "Phi_C" of a flexible body; those without values are
/// omitted.
void write_mode_values(const ModeValues& values, const WriteValue& value, Json& j);

/// Throws bad_file for a mode or a child that is given twice.
ModeValues read_mode_values(const JsonPlace& place, const ReadValue& value);

}  // namespace titop::diagram_file
