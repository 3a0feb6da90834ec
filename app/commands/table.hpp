#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Tables of numbers: records of inputs over time, points of a sweep.
namespace titop::command_line {

/// A line of names and a line of numbers for each row.
struct CsvTable {
  std::string file;                       ///< its name, for messages
  std::vector<std::string> names;         ///< of the columns, none twice
  std::vector<std::vector<double>> rows;  ///< each with a number for every name
  std::vector<int> lines;                 ///< of the rows in the file, from 1
  /// "points.csv:4"
  std::string place(std::size_t row) const;
};

/// A CSV file (RFC 4180, with or without a byte-order mark); lines that are empty or begin with #
/// are left out. Throws bad_file with every line that does not fit, and for a file without rows.
CsvTable read_table(const std::filesystem::path& file);

}  // namespace titop::command_line
