#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

/// Reader for the matrices that Nastran writes by OUTPUT4 (also DMAP's MATOP4 of EXTSEOUT).
namespace titop::fe {

/// A matrix of an OP4 file.
struct Op4Matrix {
  std::string name;  ///< as in the file, in capitals
  int form = 2;      ///< Nastran's: 1 square, 2 rectangular, 6 symmetric
  Eigen::MatrixXd value;
  double digits = 15;  ///< decimal digits that the entries carry: by precision, or by the format
};

/// All real matrices of a file, in its order. The format is detected: text or binary, dense or
/// sparse (with or without BIGMAT, detected per matrix), single or double precision, words of 4
/// or 8 bytes in either byte order.
///
/// Throws bad_file, naming the file, the matrix and the record (binary: with its byte) or line: a
/// record that ends early or differs from its stated length, a column or row outside the matrix,
/// columns that do not ascend, a value that is no finite number, a complex matrix, one of more than
/// 25 million entries, more than 100 million in the file, a name twice. Dense: 8 bytes per entry.
std::vector<Op4Matrix> read_op4(const std::filesystem::path& path);

/// The matrix of this name (capitals or not); throws unknown_name with those there are.
const Op4Matrix& find_matrix(const std::vector<Op4Matrix>& matrices, const std::string& name);

}  // namespace titop::fe
