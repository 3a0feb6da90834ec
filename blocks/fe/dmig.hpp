#pragma once

#include <filesystem>
#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <vector>

/// Reader for direct matrix input at grids (DMIG), which Nastran writes by EXTSEOUT(DMIGPCH) or
/// PUNCH.
namespace titop::fe {

/// Names of the matrices of a file. Throws the errors of `read_dmig` for broken cards.
std::vector<std::string> dmig_names(const std::filesystem::path& path);

/// The stiffness and mass of these names, e.g. "KAAX", "MAAX". Rows: all degrees of freedom that
/// either has, by grid and component; if only one has them the other is 0 there.
///
/// Entries are in fields of 8 or 16 columns (DMIG, DMIG*), with continuations; real, square (form
/// 1) or symmetric (form 6: one triangle, or both, equal). Other cards are ignored. `digits`: those
/// of the longest number of each matrix, the fewer of the two, at most 7 if one is of single
/// precision (type 1).
///
/// Throws bad_file, all mistakes together, with file and line: a DMIG card in free fields, in small
/// letters or with tabs, a field that is no number, a component outside 0 to 6, an entry twice with
/// different values, a column before its matrix's header, a complex or rectangular matrix, entries
/// without value, an unknown name (with the names in the file), a last line without line end (its
/// number may be cut short). A file truncated at the end of a line looks complete: missing entries
/// are 0.
GridMatrices read_dmig(const std::filesystem::path& path, const std::string& stiffness,
                       const std::string& mass);

}  // namespace titop::fe
