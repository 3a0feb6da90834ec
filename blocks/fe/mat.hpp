#pragma once

#include <filesystem>
#include <titop/blocks/fe/op4.hpp>
#include <vector>

/// Reader for matrices in MAT-files of MATLAB and Octave, version 5 (`save -v6`, `-v7`).
namespace titop::fe {

/// All variables of a file, in its order, as `read_op4` gives those of an OP4, with form 0. Real
/// matrices of doubles (15 digits) or singles (7), dense or sparse; others, and those of more than
/// 25 million entries, or beyond 100 million of the file, are listed in `unread`. Names are in
/// capitals, as `find_matrix` takes them: two that differ only in case are one name, twice. A file
/// truncated between two variables looks complete.
///
/// Throws bad_file, naming the variable, for other files, data that end early or are damaged,
/// entries that are no finite numbers; and for compressed variables (-v7) if the library was built
/// without zlib.
std::vector<Op4Matrix> read_mat(const std::filesystem::path& path);

}  // namespace titop::fe
