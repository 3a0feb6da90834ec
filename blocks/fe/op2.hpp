#pragma once

#include <filesystem>
#include <string>
#include <titop/blocks/fe/fortran_records.hpp>
#include <titop/blocks/fe/op4.hpp>
#include <vector>

/// Reader for the results that Nastran writes by OUTPUT2 (PARAM,POST,-1 or -2): `.op2`.
namespace titop::fe {

/// A data block that is no matrix: its records, as in the file.
struct Op2Table {
  std::string name;                  ///< "LAMA", "OUGV1", "GEOM1", ...
  std::vector<std::string> records;  ///< bytes; the first is its header
};

struct Op2File {
  std::string name;  ///< for messages
  std::vector<Op4Matrix> matrices;
  std::vector<Op2Table> tables;
  detail::WordLayout layout;  ///< of the tables' bytes
};

/// All data blocks of a file, in its order; names may repeat. Words of 4 or 8 bytes in either byte
/// order; matrices real, single or double, as `read_op4` takes and limits them.
///
/// Throws bad_file, naming the file, the data block, the record and its byte: a record that ends
/// early or differs from its stated length, a marker that is not the next one, a row or column
/// outside a matrix, a value that is no finite number.
Op2File read_op2(const std::filesystem::path& path);

}  // namespace titop::fe
