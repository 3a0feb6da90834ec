#include <titop/emit/text/csv.hpp>

namespace titop::emit {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& fields) {
  std::string text;
  for (std::size_t i = 0; i < fields.size(); ++i) text += (i ? "," : "") + csv_field(fields[i]);
  return text;
}

std::vector<std::string> csv_fields(std::string_view line) {
  constexpr const char* kBlanks = " \t\r";
  std::vector<std::string> fields(1);
  bool quoted = false, was_quoted = false;
  const auto finish = [&] {
    std::string& f = fields.back();
    if (was_quoted) return;
    f.erase(0, std::min(f.find_first_not_of(kBlanks), f.size()));
    f.erase(f.find_last_not_of(kBlanks) + 1);
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"' &&
               (quoted || fields.back().find_first_not_of(kBlanks) == std::string::npos)) {
      if (!quoted) fields.back().clear();
      quoted = !quoted, was_quoted = true;
    } else if (c == ',' && !quoted) {
      finish();
      fields.emplace_back(), was_quoted = false;
    } else if (quoted || !was_quoted) {
      fields.back() += c;
    }
  }
  finish();
  return fields;
}

}  // namespace titop::emit
