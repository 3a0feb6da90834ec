#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <titop/blocks/fe/op4.hpp>
#include <titop/blocks/fe/text_file.hpp>

/// Common to the readers of text and binary OP4.
namespace titop::fe::detail {

/// Throws bad_file for this place of the file.
using Refuse = std::function<void(const std::string& found, const std::string& expected)>;

std::string capitals(std::string_view text);

/// First record of a matrix.
struct Op4Header {
  std::string name;
  long long columns = 0, rows = 0, form = 0, type = 0;
  bool bigmat = false;  ///< rows was negative, or 65536 and more
};

/// The matrices requested by name, and those read so far.
struct Op4Taken {
  std::set<std::string> only;  ///< names in capitals; empty: all
  long long entries = 0;
};

/// The reason why a matrix of this size, above 0, is not to be read: 25 million entries, or 100
/// million with those taken before. Empty if it is read.
std::string too_large(long long rows, long long columns, Op4Taken& taken);

/// The empty matrix of this header; `unread` is the reason if it is not to be filled. Refuses
/// invalid headers.
Op4Matrix make_matrix(const Op4Header& header, Op4Taken& taken, const Refuse& refuse);

/// Puts values into a column from a row on (both from 0); refuses rows outside, values that are not
/// finite. Does nothing for a matrix that is not to be read.
void put_values(Op4Matrix& matrix, long long row, long long column, std::span<const double> values,
                const Refuse& refuse);

/// Columns come in ascending order, each once; `last` is the one before and becomes this one.
void require_ascending(long long column, long long& last, const Refuse& refuse);

/// Words of 4 bytes per real number, and numbers per value: types 1 real single, 2 real double, 3
/// complex single, 4 complex double.
inline int words_per_number(long long type) { return type == 1 || type == 3 ? 1 : 2; }
inline int numbers_per_value(long long type) { return type <= 2 ? 1 : 2; }
inline int words_per_value(long long type) {
  return words_per_number(type) * numbers_per_value(type);
}

/// The head of a string in a column of a sparse matrix.
struct Op4String {
  long long row = 0;    ///< from 0
  long long words = 0;  ///< of its values
};
/// Without BIGMAT both are packed into one integer.
inline Op4String unpacked(long long is) { return {(is & 0xffff) - 1, (is >> 16) - 1}; }

std::vector<Op4Matrix> read_op4_binary(const std::string& name, std::span<const char> bytes,
                                       Op4Taken taken);
std::vector<Op4Matrix> read_op4_text(const TextFile& file, Op4Taken taken);

}  // namespace titop::fe::detail
