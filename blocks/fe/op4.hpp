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
  std::string unread = {};  ///< why `value` is empty, for messages; empty: it was read
};

/// All matrices of a file, in its order; names may repeat. The format is detected: text or binary,
/// dense or sparse (with or without BIGMAT, detected per matrix), single or double precision, words
/// of 4 or 8 bytes in either byte order. Text that is declared single but printed with more digits
/// (type 1 with 3E22.15) has those digits, unless all its numbers are single ones.
///
/// `only`: names of the matrices to read (capitals or not); all if empty. Listed with the reason in
/// `unread`, and not read: the others, complex matrices, those of more than 25 million entries, and
/// those beyond 100 million of the file. Dense: 8 bytes per entry.
///
/// Throws bad_file, naming the file, the matrix and the record (binary: with its byte) or line: a
/// record that ends early or differs from its stated length, a column or row outside the matrix,
/// columns that do not ascend, a value that is no finite number, a type other than 1 to 4.
std::vector<Op4Matrix> read_op4(const std::filesystem::path& path,
                                const std::vector<std::string>& only = {});

/// The matrix of this name (capitals or not). Throws unknown_name with the names in the file,
/// bad_file for one that was not read, or that occurs several times with different values.
const Op4Matrix& find_matrix(const std::vector<Op4Matrix>& matrices, const std::string& name);

}  // namespace titop::fe
