#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Tables of numbers: records of inputs over time, points of a sweep.
namespace titop::command_line {

/// A line of names and a line of numbers for each row.
struct Table {
  std::vector<std::string> names;         ///< of the columns, none twice
  std::vector<std::vector<double>> rows;  ///< each with a number for every name
};

/// A CSV file: fields between commas, blanks around them ignored, lines that are empty or begin
/// with # left out. Throws bad_file with every line that does not fit, and for a file without rows.
Table read_table(const std::filesystem::path& file);

/// Names as fields of a CSV file (RFC 4180), joined by commas.
std::string header_of(const std::vector<std::string>& names);

}  // namespace titop::command_line
