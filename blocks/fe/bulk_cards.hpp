#pragma once

#include <string>
#include <string_view>
#include <titop/blocks/fe/text_file.hpp>
#include <vector>

/// Cards of Nastran bulk data. For the folder's own files.
namespace titop::fe::detail {

struct BulkCard {
  std::string name;                      ///< in capitals, without *
  std::vector<std::string_view> fields;  ///< trimmed, without name and continuation marks
  int line = 0;
  std::string mark = {};     ///< of the last line, for its continuation, without + or *
  std::string mistake = {};  ///< a tab, data that no field takes, another card's continuation

  /// Empty behind the last one.
  std::string_view field(std::size_t i) const {
    return i < fields.size() ? fields[i] : std::string_view();
  }
};

/// All cards, from BEGIN BULK on if there is one, to ENDDATA. Views into the file's text. Eight
/// fields per line, four of 16 columns; free fields separated by commas.
std::vector<BulkCard> bulk_cards(const TextFile& file);

}  // namespace titop::fe::detail
