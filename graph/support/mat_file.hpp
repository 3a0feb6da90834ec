#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

/// MAT-files of MATLAB and Octave, version 5, by libmatio; without it both functions throw bad_file
/// with the way out. For the library's own files.
namespace titop::detail {

/// A variable of a file.
struct MatMatrix {
  std::string name;  ///< as in the file, small letters differ from capitals
  Eigen::MatrixXd value;
  bool single = false;      ///< seven digits
  std::string unread = {};  ///< why `value` is empty, for messages; empty: it was read
};

/// A cell array of texts, in a column.
struct MatTexts {
  std::string name;
  std::vector<std::string> texts;
};

/// All variables, in the file's order. Real matrices of doubles or singles, dense or sparse, are
/// read; others are listed in `unread`, as are those beyond 25 million entries. A file truncated
/// between two variables looks complete. Throws bad_file for another kind of file, and for data
/// that end early.
std::vector<MatMatrix> read_mat_file(const std::filesystem::path& path);

/// Doubles, not compressed. Throws bad_file if it cannot be written.
void write_mat_file(const std::filesystem::path& path, const std::vector<MatMatrix>& matrices,
                    const std::vector<MatTexts>& texts);

}  // namespace titop::detail
