#pragma once

#include <filesystem>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <vector>

/// Reader for positions and frames of grids in Nastran bulk data: `.dat`, `.bdf`, and the `.asm`
/// that EXTSEOUT writes beside an OP4.
namespace titop::fe {

/// The GRIDs of a file by ascending number, which is the order of the rows of its matrices:
/// positions in the basic frame, and the rotation from each grid's displacement frame to it. All
/// other cards are ignored.
///
/// Cards are in fields of 8 or 16 columns or separated by commas, with continuations. Coordinate
/// systems are CORD1R, CORD1C, CORD1S, by grids, and CORD2R, CORD2C, CORD2S, by points, also
/// relative to others. The displacement frame of a grid in a cylindrical or spherical system has
/// the directions of r, theta, z, or r, theta, phi, at the grid; on the system's axis those of its
/// x, y, z. Positions are in the data's unit of length.
///
/// Throws bad_file, all mistakes together, with file and line: a field that is no number, a grid or
/// a coordinate system twice with different data, a coordinate system that is not there, refers to
/// itself or over more than 1000 others to the basic one, one of another kind that a grid uses
/// (CORD3G), axes without directions, INCLUDE and GRDSET (their effect would be missing), tabs
/// between columns, data behind the last field of a line, a continuation whose mark is not that of
/// its card or that is missing, no GRID at all.
std::vector<Grid> read_grids(const std::filesystem::path& path);

/// The same of a text in memory. For the folder's own files.
namespace detail {
std::vector<Grid> grids_in(const TextFile& file);
}

}  // namespace titop::fe
