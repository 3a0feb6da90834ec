#pragma once

#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

/// From matrices and grids of files to a mesh. For the folder's own files.
namespace titop::fe {

/// The grids of which the matrices have rows.
std::vector<Grid> with_rows(std::vector<Grid> grids, const GridMatrices& matrices);

/// The mesh without empty rows; without `grids` they are placed by statics from the grid `parent`,
/// or from the first one that gives rigid motions. A line per fact goes to `text`.
Mesh mesh_of_matrices(GridMatrices matrices, std::vector<Grid> grids, const std::string& parent,
                      std::string& text);

}  // namespace titop::fe
