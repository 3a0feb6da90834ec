#include "commands/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::command_line {
namespace {

/// A name may be in quotation marks: "re(y/u)".
std::string unquoted(std::string_view field) {
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    field = field.substr(1, field.size() - 2);
  return std::string(field);
}

class TableReader {
 public:
  explicit TableReader(const fe::TextFile& file) : file_(file) {
    fe::require_text(file);
    for (const fe::TextLine& line : fe::lines_of(file)) {
      const std::string_view text = fe::trim(line.text);
      if (text.empty() || text.front() == '#') continue;
      if (table.names.empty())
        read_names(line.number, fe::comma_fields(text));
      else
        read_row(line.number, fe::comma_fields(text));
    }
    if (table.rows.empty())
      mistakes_.add(fe::bad_line(file_, 0, "no row of numbers", "names, then rows of numbers"));
    mistakes_.finish();
  }
  Table table;

 private:
  void read_names(int line, const std::vector<std::string_view>& fields) {
    for (const std::string_view field : fields) {
      std::string name = unquoted(field);
      if (name.empty())
        mistakes_.add(fe::bad_line(file_, line, "a column without a name", "a name for each"));
      else if (std::find(table.names.begin(), table.names.end(), name) != table.names.end())
        mistakes_.add(fe::bad_line(file_, line, fmt::format("{} again", name), "each name once"));
      table.names.push_back(std::move(name));
    }
  }
  void read_row(int line, const std::vector<std::string_view>& fields) {
    if (fields.size() != table.names.size()) {
      mistakes_.add(fe::bad_line(file_, line, fmt::format("{} fields", fields.size()),
                                 fmt::format("{}, one for each name", table.names.size())));
      return;
    }
    std::vector<double>& row = table.rows.emplace_back();
    for (const std::string_view field : fields)
      if (!fe::parse(field, row.emplace_back()))
        mistakes_.add(fe::bad_line(file_, line, fmt::format("'{}'", field), "a number"));
  }

  const fe::TextFile& file_;
  fe::FileMistakes mistakes_;
};

}  // namespace

Table read_table(const std::filesystem::path& file) {
  const fe::TextFile text = fe::read_text(file);
  return TableReader(text).table;
}

std::string header_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    std::string field = name;
    if (name.find_first_of(",\"\r\n") != std::string::npos) {
      field = "\"";
      for (const char c : name) field += c == '"' ? "\"\"" : std::string(1, c);
      field += "\"";
    }
    text += (text.empty() ? "" : ",") + field;
  }
  return text;
}

}  // namespace titop::command_line
