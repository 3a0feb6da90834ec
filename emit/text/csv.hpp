#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Fields of CSV files as in RFC 4180.
namespace titop::emit {

/// A field, in quotation marks if it has a comma, a quotation mark or a line end.
std::string csv_field(const std::string& text);
/// A line of fields, without its end.
std::string csv_line(const std::vector<std::string>& fields);
/// The fields of a line, without blanks around them, without their quotation marks.
std::vector<std::string> csv_fields(std::string_view line);

}  // namespace titop::emit
