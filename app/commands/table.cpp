#include "commands/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/fe/text_file.hpp>
#include <titop/emit/text/csv.hpp>

namespace titop::command_line {
namespace {

class TableReader {
 public:
  explicit TableReader(const fe::TextFile& file) : file_(file) {
    table.file = file.name;
    fe::require_text(file);
    for (const fe::TextLine& line : fe::lines_of(file)) {
      const std::string_view text = fe::trim(line.text);
      if (text.empty() || text.front() == '#') continue;
      if (table.names.empty())
        read_names(line.number, emit::csv_fields(text));
      else
        read_row(line.number, emit::csv_fields(text));
    }
    if (table.rows.empty())
      mistakes_.add(fe::bad_line(file_, 0, "no row of numbers", "names, then rows of numbers"));
    mistakes_.finish();
  }
  CsvTable table;

 private:
  void read_names(int line, const std::vector<std::string>& fields) {
    for (const std::string& name : fields) {
      if (name.empty())
        mistakes_.add(fe::bad_line(file_, line, "a column without a name", "a name for each"));
      else if (std::find(table.names.begin(), table.names.end(), name) != table.names.end())
        mistakes_.add(fe::bad_line(file_, line, fmt::format("{} again", name), "each name once"));
      table.names.push_back(name);
    }
  }
  void read_row(int line, const std::vector<std::string>& fields) {
    if (fields.size() != table.names.size()) {
      mistakes_.add(
          fe::bad_line(file_, line, fmt::format("{} fields", fields.size()),
                       fmt::format("{}, one for each name, between commas", table.names.size())));
      return;
    }
    std::vector<double>& row = table.rows.emplace_back();
    table.lines.push_back(line);
    for (const std::string& field : fields)
      if (!fe::parse(field, row.emplace_back()))
        mistakes_.add(fe::bad_line(file_, line, fmt::format("'{}'", field), "a number"));
  }

  const fe::TextFile& file_;
  fe::FileMistakes mistakes_;
};

}  // namespace

std::string CsvTable::place(std::size_t row) const {
  return fmt::format("{}:{}", file, lines[row]);
}

CsvTable read_table(const std::filesystem::path& file) {
  fe::TextFile text = fe::read_text(file);
  if (text.content.starts_with("\xEF\xBB\xBF")) text.content.erase(0, 3);
  return TableReader(text).table;
}

}  // namespace titop::command_line
