#pragma once

#include <string>
#include <titop/analysis/damping/damping_of_assembly.hpp>
#include <vector>

/// A part of a scene as one undamped body. For the folder's own files.
namespace titop::detail {

/// The part between its root and ports as modal data, clamped at the root, with xi = 0: the modes
/// of the assembly in place of those of its bodies. Throws as `damping_of_assembly`.
ModalData assembled_part(const Diagram& part, const std::string& root,
                         const std::vector<AssemblyPort>& ports);

}  // namespace titop::detail
