#pragma once

#include <string>
#include <titop/blocks/fe/import.hpp>
#include <utility>
#include <vector>

/// Options of an import, as each kind of file takes them. For the folder's own files.
namespace titop::fe {

/// Options that a kind of file takes.
struct TakenOptions {
  bool ports = false;     ///< parent, children
  bool units = false;     ///< units
  bool grids = false;     ///< grids
  bool matrices = false;  ///< stiffness, mass
  bool modes = false;     ///< modes, but for xi
  bool xi = false;        ///< modes.xi
};

/// Throws bad_value with all given options that would have no effect.
void refuse_others(const ImportOptions& options, const TakenOptions& taken,
                   const std::string& file);

/// Names of stiffness and mass among those of `file`. Throws unknown_name.
std::pair<std::string, std::string> chosen_pair(const ImportOptions& options,
                                                const std::vector<std::string>& there,
                                                const std::string& file);

/// One damping ratio for all modes, or one per mode; none: unchanged. Throws size.
void set_damping(const std::vector<double>& xi, ModalData& data);

}  // namespace titop::fe
